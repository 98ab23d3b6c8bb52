"""Pages of the documentation that scripts rewrite between two marks."""
import pathlib


def replace_between(path, begin, end, text):
    """Puts `text` between the lines `begin` and `end` of a page; both must be there."""
    path = pathlib.Path(path)
    page = path.read_text(encoding="utf-8")
    if page.count(begin) != 1 or page.count(end) != 1 or page.index(begin) > page.index(end):
        raise ValueError(f"{path}: needs the line {begin} and, after it, the line {end}, once each")
    head, tail = page[:page.index(begin) + len(begin)], page[page.index(end):]
    path.write_text(f"{head}\n{text.strip()}\n{tail}" if text.strip() else f"{head}\n{tail}", encoding="utf-8")
