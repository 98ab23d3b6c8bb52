#include <random>

#include "io/solver_fixture.h"

namespace anatomesh::testing {
namespace {

using SolverDamage = SolverFile;

/// Four tissues of a strip of tetrahedra.
TetMesh strip() {
  TetMesh mesh;
  for (int n = 0; n < 40; ++n) mesh.points_mm.push_back({n / 3.0, (n % 2) * 1.1, (n % 3) / 7.0});
  for (VertexId n = 0; n + 3 < 40; ++n) {
    mesh.tets.push_back({n, n + 1, n + 2, n + 3});
    mesh.labels.push_back(n / 10 + 1);
  }
  mesh.names[2].name = "two";
  return mesh;
}

/// The text with a line taken out, twice there, or beside one from elsewhere, or with another word for one of its own.
std::string damaged(std::vector<std::string> lines, std::mt19937& random) {
  static const std::vector<std::string> kWords = {
      "", "-1", "99999999999999999999", "1e999", "nan", "*", ",,,", "*NODE", "<!--", "--", "GENERATE", "CTETRA*"};
  std::string& line = lines[random() % lines.size()];
  const std::string other = lines[random() % lines.size()];
  const std::size_t at = line.empty() ? 0 : random() % line.size();
  switch (random() % 4) {
    case 0:
      line.clear();
      break;
    case 1:
      line += "\n" + line;
      break;
    case 2:
      line += "\n" + other;
      break;
    default:
      line.replace(at, random() % 8, kWords[random() % kWords.size()]);
  }
  std::string text;
  for (const std::string& each : lines) text += each + "\n";
  return text;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t begin = 0, end = 0; end != std::string::npos; begin = end + 1) {
    end = text.find('\n', begin);
    lines.push_back(text.substr(begin, end - begin));
  }
  return lines;
}

TEST_F(SolverDamage, NeverCrashes) {
  std::mt19937 random(11);
  for (const std::string name : kSolverFiles) {
    const std::vector<std::string> lines = lines_of(written(name, strip()));
    for (int trial = 0; trial < 400; ++trial) {
      const std::string message = message_of_damaged(put(name, damaged(lines, random)));
      if (message.empty()) continue;
      EXPECT_SAYS(message, "mesh.");
    }
    written("mesh.node", strip());  // both files of the pair whole again
  }
}

}  // namespace
}  // namespace anatomesh::testing
