// Images: named values one after another in one block of bytes, which needs no library to be read.
// What holds a model where HDF5 is not.
//
//   bytes 0-7    "rbvi-img"
//         8-15   schema version           (this and the next two: unsigned, little-endian)
//         16-23  length of the image
//         24-31  checksum of the bytes behind it, by words of eight
//         32-    entries: type, length of the name, rows, columns (32, 32, 64, 64 bits), the name,
//                the values: doubles column by column, integers of 32 bits, or texts, each its
//                length (64 bits) and its bytes; name, values and each text filled up with zeros to
//                a multiple of eight
#pragma once

#include "rbvi/core/dense.hpp"

#include <cstddef>
#include <filesystem>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace rbvi {

using Bytes = std::span<const std::byte>;

/// Collects named values; a name that is taken is a failure.
class ImageWriter {
public:
  void write(const std::string &name, const Matrix &value);
  void write(const std::string &name, const Vector &value);
  void write(const std::string &name, const std::vector<double> &value);
  void write(const std::string &name, const std::vector<int> &value);
  void write(const std::string &name, const std::vector<std::string> &value);
  void write(const std::string &name, const std::string &value);
  void write(const std::string &name, double value);
  void write(const std::string &name, int value);
  /// The whole image. `schema`: its version.
  std::string image(int schema) const;

private:
  void add(const std::string &name, const std::string &entry);
  std::map<std::string, std::string> entries_;
};

/// Values of an image that it does not own. Throws bad_input, naming `what`, for one that is cut
/// short, damaged, or of another version, for a name that is missing or of another type.
class ImageReader {
public:
  ImageReader(Bytes image, std::string what, int schema);
  bool has(const std::string &name) const { return entries_.contains(name); }
  /// T: what H5Writer writes.
  template <class T> T read(const std::string &name) const;

private:
  struct Entry {
    int type;
    Index rows, columns;
    const std::byte *values;
    std::size_t size;
  };
  const Entry &entry(const std::string &name, int type) const;
  std::string what_;
  std::map<std::string, Entry, std::less<>> entries_;
};

/// Whether bytes, or the first of them, are those of an image.
bool is_image(Bytes start);

/// By the length and the checksum of an image; `start`: its header or more of it. Throws bad_input
/// where it is none.
std::string guid_of(Bytes start);

/// All bytes of a file, or the first `most`. Throws bad_input where it cannot be read.
std::vector<std::byte> bytes_of_file(const std::filesystem::path &path,
                                     std::size_t most = std::numeric_limits<std::size_t>::max());

} // namespace rbvi
