// Sealed HDF5 files: a 512-byte user block with magic, length and checksum stands before the HDF5
// bytes, and is verified before HDF5 sees any of them. A file is built in memory, then written,
// fsynced and renamed in one step, so that a reader meets the old file, the new one, or none.
#pragma once

#include "rbvi/core/dense.hpp"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace rbvi {

/// Collects named data sets ("group/name"; groups are made as needed) in memory.
class H5Writer {
public:
  H5Writer();
  ~H5Writer();
  H5Writer(H5Writer &&) noexcept;
  H5Writer &operator=(H5Writer &&) noexcept;
  void write(const std::string &name, const Matrix &value); ///< rows x cols, row-major on disk
  void write(const std::string &name, const Vector &value);
  void write(const std::string &name, const std::vector<double> &value);
  void write(const std::string &name, const std::vector<int> &value);
  void write(const std::string &name, const std::vector<std::string> &value);
  void write(const std::string &name, const std::string &value);
  void write(const std::string &name, double value);
  void write(const std::string &name, int value);
  /// Seals and commits. `kind` says what the file is ("model", "sample"); `schema` its version.
  /// Throws failure (directory not writable, disk full): then nothing of the name `path` changed
  /// and no temporary file is left.
  void commit(const std::filesystem::path &path, const std::string &kind, int schema);

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Opens a sealed file. Throws bad_input with one line that tells apart: missing, not an rbvi file,
/// truncated, damaged (checksum), of another kind, of another schema version.
class H5Reader {
public:
  H5Reader(const std::filesystem::path &path, const std::string &kind, int schema);
  ~H5Reader();
  H5Reader(H5Reader &&) noexcept;
  H5Reader &operator=(H5Reader &&) noexcept;
  bool has(const std::string &name) const;
  Matrix matrix(const std::string &name) const;
  Vector vector(const std::string &name) const;
  std::vector<double> doubles(const std::string &name) const;
  std::vector<int> ints(const std::string &name) const;
  std::vector<std::string> strings(const std::string &name) const;
  std::string string(const std::string &name) const;
  double number(const std::string &name) const;
  int integer(const std::string &name) const;

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Writes `bytes` to `path` atomically: temporary file beside it, fsync, rename, fsync of the
/// directory. Throws failure; then no temporary file is left.
void write_atomically(const std::filesystem::path &path, const std::string &bytes);

/// FNV-1a, 64 bits: names sample files and seals files.
std::uint64_t fnv1a(const void *bytes, std::size_t size);

} // namespace rbvi
