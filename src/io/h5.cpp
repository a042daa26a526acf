#include "rbvi/io/h5.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/io/write_atomically.hpp"
#include "seal.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstdint>
#include <hdf5.h>

namespace rbvi {

namespace {

using Path = std::filesystem::path;
const std::string hdf5_signature = "\x89HDF\r\n\x1a\n";

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// How many entries are zero or have no more digits than a number in single precision.
Index ending_in_zeros(const RowMajor &rows) {
  constexpr std::uint64_t last = 0xffffff;
  return std::count_if(rows.data(), rows.data() + rows.size(), [](double value) {
    return (std::bit_cast<std::uint64_t>(value) & last) == 0;
  });
}

/// Owns one HDF5 identifier.
class Id {
public:
  Id() = default;
  Id(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  Id(Id &&other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Id &operator=(Id &&other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~Id() {
    if (id_ >= 0) close_(id_);
  }
  hid_t get() const { return id_; }

private:
  hid_t id_ = -1;
  herr_t (*close_)(hid_t) = nullptr;
};

Id text_type() {
  Id type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), H5T_VARIABLE);
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  return type;
}

/// HDF5 takes two open files of one name for the same file, even in memory.
std::string unused_name() {
  static std::atomic<unsigned> count = 0;
  return "rbvi-" + std::to_string(count++);
}

/// Without locks, which not every file system has: files of ours are never changed.
Id disk_access() {
  Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_file_locking(access.get(), false, true);
  return access;
}

Id memory_access() {
  Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fapl_core(access.get(), std::size_t{1} << 20, false);
  return access;
}

} // namespace

void start_hdf5() {
  H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

struct H5Writer::Impl {
  std::unique_ptr<AtomicFile> disk; ///< null: in memory
  Id file;

  void create(const char *name, hid_t access) {
    const Id properties(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
    H5Pset_userblock(properties.get(), seal_size);
    file = Id(H5Fcreate(name, H5F_ACC_TRUNC, properties.get(), access), H5Fclose);
    if (file.get() < 0) throw failure("HDF5 cannot make a file");
  }

  /// A new data set; an empty `shape` is a scalar. A `packed` one, of two dimensions, is
  /// compressed.
  Id make(const std::string &name, const std::vector<hsize_t> &shape, hid_t disk_type,
          bool packed = false) const {
    const Id space(shape.empty()
                       ? H5Screate(H5S_SCALAR)
                       : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
                   H5Sclose);
    const Id link(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
    H5Pset_create_intermediate_group(link.get(), 1);
    const Id properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_obj_track_times(properties.get(), false);
    if (packed) {
      constexpr hsize_t entries = hsize_t{1} << 17;
      const std::array<hsize_t, 2> chunk{std::clamp<hsize_t>(entries / shape[1], 1, shape[0]),
                                         shape[1]};
      H5Pset_chunk(properties.get(), 2, chunk.data());
      H5Pset_shuffle(properties.get()); // first bytes of all entries first
      H5Pset_deflate(properties.get(), 1);
    }
    return {H5Dcreate2(file.get(), name.c_str(), disk_type, space.get(), link.get(),
                       properties.get(), H5P_DEFAULT),
            H5Dclose};
  }

  void write(const std::string &name, const std::vector<hsize_t> &shape, hid_t disk_type,
             hid_t memory, const void *data, bool packed = false) const {
    const Id set = make(name, shape, disk_type, packed);
    // HDF5 wants an address even where there is nothing to write.
    const double nothing = 0;
    if (set.get() < 0 || H5Dwrite(set.get(), memory, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                                  data != nullptr ? data : &nothing) < 0)
      throw failure("HDF5 cannot write the data set '" + name + "' (is the name taken?)");
  }
};

H5Writer::H5Writer() : impl_(std::make_unique<Impl>()) {
  start_hdf5();
  impl_->create(unused_name().c_str(), memory_access().get());
}

H5Writer::H5Writer(const Path &path) : impl_(std::make_unique<Impl>()) {
  start_hdf5();
  impl_->disk = std::make_unique<AtomicFile>(path);
  impl_->create(impl_->disk->temporary().c_str(), disk_access().get());
}

H5Writer::~H5Writer() = default;
H5Writer::H5Writer(H5Writer &&) noexcept = default;
H5Writer &H5Writer::operator=(H5Writer &&) noexcept = default;

void H5Writer::write(const std::string &name, const Matrix &value) {
  constexpr Index small = 4096;
  const RowMajor rows = value;
  const bool packs = rows.size() > small && 2 * ending_in_zeros(rows) > rows.size();
  impl_->write(name, {static_cast<hsize_t>(rows.rows()), static_cast<hsize_t>(rows.cols())},
               H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, rows.data(), packs);
}

void H5Writer::create_rows(const std::string &name, Index rows, Index columns) {
  const std::vector<hsize_t> shape{static_cast<hsize_t>(rows), static_cast<hsize_t>(columns)};
  const Id set = impl_->make(name, shape, H5T_IEEE_F64LE);
  if (set.get() < 0) throw failure("HDF5 cannot make the data set '" + name + "'");
}

void H5Writer::write_rows(const std::string &name, Index first, const Matrix &value) {
  const RowMajor rows = value;
  const std::array<hsize_t, 2> start{static_cast<hsize_t>(first), 0},
      count{static_cast<hsize_t>(rows.rows()), static_cast<hsize_t>(rows.cols())};
  const Id set(H5Dopen2(impl_->file.get(), name.c_str(), H5P_DEFAULT), H5Dclose);
  const Id space(H5Dget_space(set.get()), H5Sclose);
  const Id memory(H5Screate_simple(2, count.data(), nullptr), H5Sclose);
  if (H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(),
                          nullptr) < 0 ||
      H5Dwrite(set.get(), H5T_NATIVE_DOUBLE, memory.get(), space.get(), H5P_DEFAULT, rows.data()) <
          0)
    throw failure("HDF5 cannot write the data set '" + name + "' (is the disk full?)");
}

void H5Writer::write(const std::string &name, const Vector &value) {
  impl_->write(name, {static_cast<hsize_t>(value.size())}, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE,
               value.data());
}

void H5Writer::write(const std::string &name, const std::vector<double> &value) {
  impl_->write(name, {value.size()}, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, value.data());
}

void H5Writer::write(const std::string &name, const std::vector<int> &value) {
  impl_->write(name, {value.size()}, H5T_STD_I32LE, H5T_NATIVE_INT, value.data());
}

void H5Writer::write(const std::string &name, const std::vector<std::string> &value) {
  std::vector<const char *> texts;
  for (const std::string &text : value)
    texts.push_back(text.c_str());
  const Id type = text_type();
  impl_->write(name, {texts.size()}, type.get(), type.get(), texts.data());
}

void H5Writer::write(const std::string &name, const std::string &value) {
  const char *text = value.c_str();
  const Id type = text_type();
  impl_->write(name, {}, type.get(), type.get(), &text);
}

void H5Writer::write(const std::string &name, double value) {
  impl_->write(name, {}, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &value);
}

void H5Writer::write(const std::string &name, int value) {
  impl_->write(name, {}, H5T_STD_I32LE, H5T_NATIVE_INT, &value);
}

void H5Writer::commit(const Path &path, const std::string &kind, int schema) {
  const hid_t file = impl_->file.get();
  if (H5Fflush(file, H5F_SCOPE_GLOBAL) < 0)
    throw failure("HDF5 cannot write " + path.string() + " (is the disk full?)");
  if (!impl_->disk) {
    const ssize_t size = H5Fget_file_image(file, nullptr, 0);
    if (size < 0) throw failure("HDF5 cannot hand out the image of " + path.string());
    std::string image(size, '\0');
    H5Fget_file_image(file, image.data(), image.size());
    // HDF5 1.10 leaves the user block out of the image; it is not documented whether others do.
    const std::size_t start = image.find(hdf5_signature);
    if (start != 0 && start != seal_size)
      throw failure("HDF5 handed out an image without its signature for " + path.string());
    impl_->disk = std::make_unique<AtomicFile>(path);
    if (start == 0) impl_->disk->append(std::string(seal_size, '\0'));
    impl_->disk->append(image);
  }
  impl_->file = Id();
  seal(impl_->disk->temporary(), kind, schema);
  impl_->disk->commit();
}

struct H5Reader::Impl {
  std::string path;
  Id file;

  Error wrong(const std::string &name, const std::string &what) const {
    return bad_input(path + ": the data set '" + name + "' " + what);
  }

  bool has(const std::string &name) const {
    for (std::size_t slash = 0; slash != std::string::npos;) {
      slash = name.find('/', slash + 1);
      if (H5Lexists(file.get(), name.substr(0, slash).c_str(), H5P_DEFAULT) <= 0) return false;
    }
    return true;
  }

  Id open(const std::string &name) const {
    if (!has(name)) throw wrong(name, "is missing");
    Id set(H5Dopen2(file.get(), name.c_str(), H5P_DEFAULT), H5Dclose);
    if (set.get() < 0) throw wrong(name, "is a group");
    return set;
  }

  /// The shape, after checks that it has `rank` dimensions and is of this class.
  std::vector<hsize_t> shape(const std::string &name, hid_t set, std::size_t rank,
                             H5T_class_t type) const {
    const Id space(H5Dget_space(set), H5Sclose);
    const Id stored(H5Dget_type(set), H5Tclose);
    if (H5Tget_class(stored.get()) != type) throw wrong(name, "is of another type");
    if (H5Sget_simple_extent_ndims(space.get()) != static_cast<int>(rank))
      throw wrong(name, "has another shape");
    std::vector<hsize_t> shape(rank);
    H5Sget_simple_extent_dims(space.get(), shape.data(), nullptr);
    return shape;
  }

  void read(const std::string &name, hid_t set, hid_t memory, void *data) const {
    double nothing = 0;
    if (H5Dread(set, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, data != nullptr ? data : &nothing) < 0)
      throw wrong(name, "cannot be read");
  }

  template <class Container>
  Container list(const std::string &name, H5T_class_t type, hid_t memory) const {
    const Id set = open(name);
    const std::vector<hsize_t> size = shape(name, set.get(), 1, type);
    Container values(static_cast<Index>(size[0]));
    read(name, set.get(), memory, values.data());
    return values;
  }

  template <class T> T scalar(const std::string &name, H5T_class_t type, hid_t memory) const {
    const Id set = open(name);
    shape(name, set.get(), 0, type);
    T value{};
    read(name, set.get(), memory, &value);
    return value;
  }
};

namespace {

/// Copies what HDF5 allocated, and frees it.
std::string take(char *text) {
  std::string copy = text != nullptr ? text : "";
  H5free_memory(text);
  return copy;
}

} // namespace

H5Reader::H5Reader(const Path &path, const std::string &kind, int schema)
    : impl_(std::make_unique<Impl>()) {
  start_hdf5();
  verify_seal(path, kind, schema);
  impl_->path = path.string();
  impl_->file = Id(H5Fopen(path.c_str(), H5F_ACC_RDONLY, disk_access().get()), H5Fclose);
  if (impl_->file.get() < 0)
    throw bad_input(path.string() + ": this version of HDF5 cannot read it");
}

H5Reader::~H5Reader() = default;
H5Reader::H5Reader(H5Reader &&) noexcept = default;
H5Reader &H5Reader::operator=(H5Reader &&) noexcept = default;

bool H5Reader::has(const std::string &name) const {
  return impl_->has(name);
}

template <> Matrix H5Reader::read(const std::string &name) const {
  const Id set = impl_->open(name);
  const std::vector<hsize_t> shape = impl_->shape(name, set.get(), 2, H5T_FLOAT);
  RowMajor rows(static_cast<Index>(shape[0]), static_cast<Index>(shape[1]));
  impl_->read(name, set.get(), H5T_NATIVE_DOUBLE, rows.data());
  return rows;
}

template <> Vector H5Reader::read(const std::string &name) const {
  return impl_->list<Vector>(name, H5T_FLOAT, H5T_NATIVE_DOUBLE);
}

template <> std::vector<double> H5Reader::read(const std::string &name) const {
  return impl_->list<std::vector<double>>(name, H5T_FLOAT, H5T_NATIVE_DOUBLE);
}

template <> std::vector<int> H5Reader::read(const std::string &name) const {
  return impl_->list<std::vector<int>>(name, H5T_INTEGER, H5T_NATIVE_INT);
}

template <> std::vector<std::string> H5Reader::read(const std::string &name) const {
  std::vector<std::string> texts;
  const Id type = text_type();
  for (char *text : impl_->list<std::vector<char *>>(name, H5T_STRING, type.get()))
    texts.push_back(take(text));
  return texts;
}

template <> std::string H5Reader::read(const std::string &name) const {
  const Id type = text_type();
  return take(impl_->scalar<char *>(name, H5T_STRING, type.get()));
}

template <> double H5Reader::read(const std::string &name) const {
  return impl_->scalar<double>(name, H5T_FLOAT, H5T_NATIVE_DOUBLE);
}

template <> int H5Reader::read(const std::string &name) const {
  return impl_->scalar<int>(name, H5T_INTEGER, H5T_NATIVE_INT);
}

} // namespace rbvi
