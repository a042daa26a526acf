// The block that seals a file of ours, see io/h5.hpp: written when the rest of the file is there,
// and verified before anything else is read. Both pass over the file once, in pieces.
#pragma once

#include <filesystem>
#include <string>

namespace rbvi {

constexpr std::size_t seal_size = 512;

/// Writes the first seal_size bytes of a file whose rest is complete. Throws failure.
void seal(const std::filesystem::path &path, const std::string &kind, int schema);

/// Throws as H5Reader where the file at `path` is not a whole one of this kind and schema.
void verify_seal(const std::filesystem::path &path, const std::string &kind, int schema);

} // namespace rbvi
