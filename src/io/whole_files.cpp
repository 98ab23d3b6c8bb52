#include "io/whole_files.h"

#include <list>
#include <system_error>

#include "anatomesh/errors.h"
#include "io/output_file.h"

namespace anatomesh {
namespace {

/// What lay at a target before, kept beside it; comes back at the end of the scope unless it is let go.
class EarlierFile {
 public:
  explicit EarlierFile(const std::filesystem::path& target) : target_(target), kept_(target) {
    std::error_code failure;
    was_there_ = std::filesystem::exists(target, failure);
    if (was_there_) std::filesystem::rename(target, kept_.temporary(), failure);
    if (was_there_ && failure) throw IoError("cannot write " + in_quotes(target) + ": " + failure.message());
  }
  ~EarlierFile() {
    if (!comes_back_) return;
    std::error_code ignored;
    std::filesystem::remove(target_, ignored);
    if (was_there_) std::filesystem::rename(kept_.temporary(), target_, ignored);
  }
  EarlierFile(const EarlierFile&) = delete;
  EarlierFile& operator=(const EarlierFile&) = delete;

  void let_go() { comes_back_ = false; }

 private:
  std::filesystem::path target_;
  OutputFile kept_;
  bool was_there_ = false;
  bool comes_back_ = true;
};

}  // namespace

void write_whole_files(const std::vector<FileBytes>& files) {
  std::list<OutputFile> written;
  for (const FileBytes& file : files) written.emplace_back(file.target).write(file.bytes);
  std::list<EarlierFile> earlier;
  for (OutputFile& file : written) {
    earlier.emplace_back(file.target());
    file.commit();
  }
  for (EarlierFile& file : earlier) file.let_go();
}

}  // namespace anatomesh
