// FNV-1a, the checksum of files and meshes.
#pragma once

#include <cstddef>
#include <cstdint>

namespace rbvi {

/// FNV-1a, 64 bits: names sample files and seals files. A change of one byte always changes it.
/// `hash`: of the bytes before these.
inline std::uint64_t fnv1a(const void *bytes, std::size_t size,
                           std::uint64_t hash = 14695981039346656037ULL) {
  const auto *data = static_cast<const unsigned char *>(bytes);
  for (std::size_t i = 0; i < size; ++i)
    hash = (hash ^ data[i]) * 1099511628211ULL;
  return hash;
}

} // namespace rbvi
