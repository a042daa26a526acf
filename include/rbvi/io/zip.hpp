// ZIP archives of files that are stored as they are.
#pragma once

#include <string>
#include <vector>

namespace rbvi {

struct ZippedFile {
  std::string name; ///< with its folders: "resources/model.rbvi"
  std::string bytes;
};

/// The bytes of the archive; the same files make the same ones. Throws bad_input for 4 GB or more.
std::string zip_of(const std::vector<ZippedFile> &files);

} // namespace rbvi
