#include "rbvi/io/vtu.hpp"
#include "rbvi/model/solution_vtu.hpp"

#include <algorithm>
#include <cctype>

namespace rbvi {

namespace fs = std::filesystem;

namespace {

/// Letters of other alphabets stay.
std::string file_safe(std::string name) {
  for (char &letter : name) {
    const auto byte = static_cast<unsigned char>(letter);
    if (byte < 0x80 && std::isalnum(byte) == 0 && letter != '-') letter = '_';
  }
  return name;
}

} // namespace

fs::path file_beside(const fs::path &path, const std::string &suffix) {
  return path.parent_path() / (path.stem().string() + suffix + path.extension().string());
}

std::vector<fs::path> contact_files(const fs::path &path, const Scene &scene,
                                    const std::string &suffix) {
  std::vector<fs::path> files;
  for (std::size_t i = 0; i < scene.contacts.size(); ++i) {
    const std::string &own = scene.contacts[i].name;
    std::string name = suffix;
    if (scene.contacts.size() > 1)
      name.append("_").append(own.empty() ? std::to_string(i + 1) : file_safe(own));
    while (std::ranges::find(files, file_beside(path, name)) != files.end()) // "a b" and "a_b"
      name += "_";
    files.push_back(file_beside(path, name));
  }
  return files;
}

std::vector<fs::path> write_vtu(const fs::path &path, const Scene &scene, const FullMu &all,
                                const ReducedModel &model, const Vector &u, const Vector &lambda) {
  const std::vector<Grid> grids = solution_grids(scene, all, model, u, lambda);
  std::vector<fs::path> files = contact_files(path, scene), written;
  files.insert(files.begin(), path);
  for (std::size_t i = 0; i < grids.size(); ++i) {
    if (i > 0 && grids[i].cells.empty()) { // nothing faces anything
      fs::remove(files[i]);
      continue;
    }
    write_vtu(files[i], grids[i], vtu_format(grids[i]));
    written.push_back(files[i]);
  }
  return written;
}

} // namespace rbvi
