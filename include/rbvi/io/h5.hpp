// Sealed HDF5 files: a 512-byte user block with magic, length and checksum stands before the HDF5
// bytes, and is verified before HDF5 sees any of them. A file is built in memory, or under another
// name where it is large, then fsynced and renamed in one step, so that a reader meets the old
// file, the new one, or none.
// Other HDF5 tools (h5dump, h5py) skip the user block and read the file as it is.
//
//   bytes 0-7    "rbvi" CR LF 0x1a LF
//         8-39   kind, padded with zeros
//         40-47  schema version           (this and the next three: unsigned, little-endian)
//         48-55  length of the file
//         56-63  FNV-1a of bytes 512-end
//         64-71  FNV-1a of bytes 0-63
//         72-511 zero
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/core/error.hpp"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace rbvi {

/// Collects named data sets ("group/name"; groups are made as needed). A name that is already taken
/// is a failure. The bytes depend on what is written alone (no time stamps).
class H5Writer {
public:
  H5Writer(); ///< in memory
  /// On the disk beside `path`, which is what commit() has to be told then.
  explicit H5Writer(const std::filesystem::path &path);
  ~H5Writer();
  H5Writer(H5Writer &&) noexcept;
  H5Writer &operator=(H5Writer &&) noexcept;
  /// rows x cols, row-major on disk; compressed where it is large and most of its entries are
  /// rounded.
  void write(const std::string &name, const Matrix &value);
  /// A matrix that comes by rows: its shape first, then some of them at a time.
  void create_rows(const std::string &name, Index rows, Index columns);
  void write_rows(const std::string &name, Index first, const Matrix &value);
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

/// A bad_input: the file is there, but is not what was written under its name.
struct DamagedFile : Error {
  /// The message is both together.
  explicit DamagedFile(const std::string &what_it_is, const std::string &hint = "")
      : Error(Status::bad_input, what_it_is + hint), fact(what_it_is) {}
  std::string fact;
};

/// A bad_input: a whole file of another schema version.
struct OtherVersion : Error {
  explicit OtherVersion(const std::string &message) : Error(Status::bad_input, message) {}
};

/// Opens a sealed file. Throws bad_input with one line that tells apart: missing; as DamagedFile
/// not readable, not an rbvi file, truncated, damaged (checksum), of another kind; as OtherVersion
/// of another schema version; and, when a data set is read, that it is missing or of another type
/// or shape.
class H5Reader {
public:
  H5Reader(const std::filesystem::path &path, const std::string &kind, int schema);
  ~H5Reader();
  H5Reader(H5Reader &&) noexcept;
  H5Reader &operator=(H5Reader &&) noexcept;
  bool has(const std::string &name) const;
  /// T: what H5Writer writes.
  template <class T> T read(const std::string &name) const;

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Errors of HDF5 come back as ours, and it does nothing at the end of the program, where it would
/// crash over a file that a full disk has left half written. Under MPI that holds only where this
/// is called before MPI is initialised. Readers and writers call it, too.
void start_hdf5();

} // namespace rbvi
