#include "rbvi/io/zip.hpp"

#include "rbvi/core/error.hpp"

#include <cstdint>
#include <initializer_list>
#include <utility>

namespace rbvi {

namespace {

/// Numbers of a header, each with the bytes that it takes.
std::string little_endian(std::initializer_list<std::pair<int, std::uint64_t>> numbers) {
  std::string header;
  for (const auto &[bytes, value] : numbers)
    for (int i = 0; i < bytes; ++i)
      header += static_cast<char>(value >> 8 * i & 0xff);
  return header;
}

/// CRC-32 of ISO 3309.
std::uint32_t crc_of(const std::string &bytes) {
  std::uint32_t crc = 0xffffffff;
  for (const char byte : bytes) {
    crc ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit)
      crc = crc >> 1 ^ ((crc & 1) != 0 ? 0xedb88320 : 0);
  }
  return ~crc;
}

} // namespace

std::string zip_of(const std::vector<ZippedFile> &files) {
  std::string archive, directory;
  for (const auto &[name, bytes] : files) {
    const std::string facts = // version 2.0, names in UTF-8, stored, at 0:00 on 1 January 1980
        little_endian({{2, 20}, {2, 0x800}, {2, 0}, {2, 0}, {2, 0x21}, {4, crc_of(bytes)}}) +
        little_endian({{4, bytes.size()}, {4, bytes.size()}, {2, name.size()}, {2, 0}});
    directory += little_endian({{4, 0x02014b50}, {2, 0x314}}) + facts + // of Unix, mode 644
                 little_endian({{6, 0}, {4, 0100644U << 16}, {4, archive.size()}}) + name;
    archive += little_endian({{4, 0x04034b50}}) + facts + name + bytes;
    if (archive.size() > 0xfff00000) throw bad_input("a ZIP archive takes less than 4 GB");
  }
  const std::size_t count = files.size(), begin = archive.size();
  return archive + directory + little_endian({{4, 0x06054b50}, {4, 0}, {2, count}, {2, count}}) +
         little_endian({{4, directory.size()}, {4, begin}, {2, 0}});
}

} // namespace rbvi
