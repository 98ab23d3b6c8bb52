// Damages mesh files of every format, again and again, and reads them: read_mesh() gives a mesh whose ids are in range
// or throws one of the library's errors. Meant to be built with the sanitizers.
//
// usage: fuzz_mesh_files FOLDER [SECONDS [SEED]]
// The folder is for the files; one that is read in any other way, or takes too long, is left there as "failed...".
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "anatomesh/errors.h"
#include "io/mesh_format.h"

namespace anatomesh::testing {
namespace {

namespace fs = std::filesystem;
using Random = std::mt19937;

constexpr unsigned kMostSeconds = 20;  // for one file

std::size_t below(Random& random, std::size_t count) { return random() % count; }

/// A block of tetrahedra with three labels, two of them with names.
TetMesh small_mesh(Random& random) {
  TetMesh mesh;
  for (int n = 0; n < 12; ++n) {
    const auto coordinate = [&] { return static_cast<double>(random()) / 1e7 - 200; };
    mesh.points_mm.push_back({coordinate(), coordinate(), coordinate()});
  }
  for (VertexId n = 0; n + 3 < 12; ++n) {
    mesh.tets.push_back({n, n + 1, n + 2, n + 3});
    mesh.labels.push_back(n < 3 ? 1 : n < 6 ? 17 : 4000);
  }
  mesh.names[1] = {"left lobe", Colour{200, 10, 30}};
  mesh.names[17] = {"vessel", Colour{1, 2, 3}};
  return mesh;
}

std::string bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

void put(const fs::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

// ---- ways to damage a file; none of them is given an empty one

void change_byte(std::string& bytes, Random& random) {
  bytes[below(random, bytes.size())] = static_cast<char>(random());
}

void flip_bit(std::string& bytes, Random& random) {
  char& byte = bytes[below(random, bytes.size())];
  byte = static_cast<char>(byte ^ (1 << below(random, 8)));
}

void truncate(std::string& bytes, Random& random) { bytes.resize(below(random, bytes.size())); }

void remove_piece(std::string& bytes, Random& random) {
  bytes.erase(below(random, bytes.size()), 1 + below(random, 60));
}

void repeat_piece(std::string& bytes, Random& random) {
  const std::size_t at = below(random, bytes.size());
  bytes.insert(below(random, bytes.size()), bytes.substr(at, 1 + below(random, 60)));
}

/// Puts an unlikely number in the place of one.
void change_number(std::string& bytes, Random& random) {
  constexpr std::array kNumbers = {"0",     "-1",  "4294967295", "4294967296", "2147483648", "99999999999999999999",
                                   "1e400", "nan", "-0",         "1.5",        "",           "18446744073709551615"};
  const std::size_t begin = bytes.find_first_of("0123456789", below(random, bytes.size()));
  if (begin == std::string::npos) return;
  const std::size_t end = std::min(bytes.find_first_not_of("0123456789.", begin), bytes.size());
  bytes.replace(begin, end - begin, kNumbers[below(random, kNumbers.size())]);
}

/// Eight bytes that are large or negative as a binary number.
void change_binary_number(std::string& bytes, Random& random) {
  if (bytes.size() < 8) return;
  const char fill = random() % 2 == 0 ? '\xff' : '\x7f';
  bytes.replace(below(random, bytes.size() - 7), 8, std::string(8, fill));
}

void damage(std::string& bytes, Random& random) {
  constexpr std::array kWays = {
      &change_byte, &flip_bit, &truncate, &remove_piece, &repeat_piece, &change_number, &change_binary_number};
  for (std::size_t left = 1 + below(random, 4); left > 0 && !bytes.empty(); --left)
    kWays[below(random, kWays.size())](bytes, random);
}

/// Whether the file is read as it should.
bool reads_well(const MeshFormat& format, const fs::path& file) {
  try {
    const TetMesh mesh = format.read(file);
    for (const auto& tet : mesh.tets) {
      for (const VertexId v : tet) {
        if (v >= mesh.points_mm.size()) return false;
      }
    }
    return mesh.labels.size() == mesh.tets.size();
  } catch (const Error&) {
    return true;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", file.c_str(), error.what());
    return false;
  }
}

/// One damaged file of one format, which may be one of several files. Returns whether it was read well.
bool try_one(const MeshFormat& format, const fs::path& folder, Random& random) {
  fs::remove_all(folder);
  fs::create_directories(folder);
  const fs::path file = folder / std::string("mesh").append(format.extension);
  format.write(file, small_mesh(random));
  std::vector<fs::path> files(fs::directory_iterator(folder), fs::directory_iterator{});
  std::ranges::sort(files);  // the same on every file system
  const fs::path& victim = files[below(random, files.size())];
  std::string bytes = bytes_of(victim);
  damage(bytes, random);
  put(victim, bytes);
  ::alarm(kMostSeconds);  // ends the process, and the file stays
  const bool well = !fs::exists(file) || reads_well(format, file);
  ::alarm(0);
  return well;
}

int run(const fs::path& folder, double seconds, unsigned seed) {
  Random random(seed);
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  std::size_t tried = 0;
  while (std::chrono::steady_clock::now() < end) {
    for (const MeshFormat& format : mesh_formats()) {
      if (format.read == nullptr) continue;
      const fs::path place = folder / std::string("failed").append(format.extension);
      if (!try_one(format, place, random)) {
        std::fprintf(stderr, "read in a wrong way: %s\n", place.c_str());
        return 1;
      }
      fs::remove_all(place);
      ++tried;
    }
  }
  std::printf("%zu damaged files, each read or refused\n", tried);
  return 0;
}

}  // namespace
}  // namespace anatomesh::testing

int main(int count, char** arguments) {
  if (count < 2) {
    std::fprintf(stderr, "usage: %s FOLDER [SECONDS [SEED]]\n", arguments[0]);
    return 2;
  }
  const double seconds = count > 2 ? std::atof(arguments[2]) : 10;
  const unsigned seed = count > 3 ? static_cast<unsigned>(std::atoi(arguments[3])) : std::random_device()();
  std::printf("seed %u\n", seed);
  std::fflush(stdout);
  return anatomesh::testing::run(arguments[1], seconds, seed);
}
