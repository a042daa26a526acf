// Files that are the old one or the new one, never half.
#pragma once

#include <filesystem>
#include <string>

namespace rbvi {

/// Writes `bytes` to `path` atomically: temporary file beside it, fsync, rename, fsync of the
/// directory; a link is followed, and a device or pipe is written directly. Throws failure; then
/// no temporary file is left.
void write_atomically(const std::filesystem::path &path, const std::string &bytes);

/// Makes a directory and those above it, where they are missing. Throws failure.
void make_directory(const std::filesystem::path &path);

} // namespace rbvi
