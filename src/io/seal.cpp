#include "seal.hpp"

#include "rbvi/io/checksum.hpp"
#include "rbvi/io/h5.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <vector>

namespace rbvi {

namespace {

using Path = std::filesystem::path;

constexpr std::size_t kind_at = 8, kind_size = 32, schema_at = 40, length_at = 48, payload_at = 56,
                      header_at = 64, header_end = 72;
const std::string magic = "rbvi\r\n\x1a\n";
const std::string hdf5_signature = "\x89HDF\r\n\x1a\n";

void put(std::string &block, std::size_t at, std::uint64_t value) {
  for (std::size_t i = 0; i < 8; ++i)
    block[at + i] = static_cast<char>((value >> (8 * i)) & 0xffU);
}

std::uint64_t get(const std::string &block, std::size_t at) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < 8; ++i)
    value |= static_cast<std::uint64_t>(static_cast<unsigned char>(block[at + i])) << (8 * i);
  return value;
}

std::string kind_field(const std::string &kind) {
  if (kind.empty() || kind.size() >= kind_size) throw failure("file kind '" + kind + "' too long");
  return kind + std::string(kind_size - kind.size(), '\0');
}

/// What stands in a file: its first block, its length, the checksum of what is behind the block.
struct Contents {
  std::string block;
  std::uint64_t length = 0, payload = fnv1a(nullptr, 0);
};

Contents contents_of(const Path &path) {
  std::ifstream in(path, std::ios::binary);
  Contents found;
  found.block.resize(seal_size);
  in.read(found.block.data(), seal_size);
  found.block.resize(in.gcount());
  found.length = found.block.size();
  std::vector<char> piece(std::size_t{1} << 20);
  while (in.good() && !in.bad()) {
    in.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    const auto count = static_cast<std::size_t>(in.gcount());
    found.payload = fnv1a(piece.data(), count, found.payload);
    found.length += count;
  }
  if (!in.is_open() || in.bad())
    throw DamagedFile(path.string() + " cannot be read: " + std::strerror(errno));
  return found;
}

} // namespace

void seal(const Path &path, const std::string &kind, int schema) {
  const Contents rest = contents_of(path);
  std::string block(seal_size, '\0');
  const std::string field = kind_field(kind);
  std::copy(magic.begin(), magic.end(), block.begin());
  std::copy(field.begin(), field.end(), block.begin() + kind_at);
  put(block, schema_at, static_cast<std::uint64_t>(schema));
  put(block, length_at, rest.length);
  put(block, payload_at, rest.payload);
  put(block, header_at, fnv1a(block.data(), header_at));
  std::fstream out(path, std::ios::binary | std::ios::in | std::ios::out);
  out.write(block.data(), seal_size);
  out.close();
  if (!out) throw failure("cannot write " + path.string() + ": " + std::strerror(errno));
}

void verify_seal(const Path &path, const std::string &kind, int schema) {
  const std::string name = path.string();
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) throw bad_input(name + " does not exist");
  if (std::filesystem::is_directory(path, ignored))
    throw DamagedFile(name + " is a directory, not an rbvi file");
  const Contents found = contents_of(path);
  const std::string &block = found.block;
  const std::string start = block.substr(0, magic.size());
  if (start.empty()) throw DamagedFile(name + " is empty");
  if (start == hdf5_signature)
    throw DamagedFile(name + " is an HDF5 file, but not one written by rbvi");
  if (start != magic.substr(0, start.size())) throw DamagedFile(name + " is not an rbvi file");
  const auto truncated = [&](const std::string &full) {
    return DamagedFile(name + " is truncated: " + std::to_string(found.length) + " of " + full +
                           " bytes",
                       "; copy or make it again");
  };
  if (block.size() < seal_size) throw truncated("at least " + std::to_string(seal_size));
  const auto damaged =
      DamagedFile(name + " is damaged (its checksum does not match)", "; copy or make it again");
  const bool rest_is_zero = block.find_first_not_of('\0', header_end) == std::string::npos;
  if (get(block, header_at) != fnv1a(block.data(), header_at) || !rest_is_zero) throw damaged;
  const std::uint64_t length = get(block, length_at);
  if (found.length < length) throw truncated(std::to_string(length));
  if (found.length > length || get(block, payload_at) != found.payload) throw damaged;
  if (block.compare(kind_at, kind_size, kind_field(kind)) != 0)
    throw DamagedFile(name + " is a " + std::string(block.c_str() + kind_at) + " file, not a " +
                      kind + " file");
  if (get(block, schema_at) != static_cast<std::uint64_t>(schema))
    throw OtherVersion(name + " has schema version " + std::to_string(get(block, schema_at)) +
                       "; this build reads version " + std::to_string(schema) +
                       ": make it again by rbvi offline");
}

} // namespace rbvi
