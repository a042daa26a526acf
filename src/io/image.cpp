#include "rbvi/io/image.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/io/system_error.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <optional>

namespace rbvi {

static_assert(std::endian::native == std::endian::little, "images are little-endian");

namespace {

constexpr std::string_view image_magic = "rbvi-img";
constexpr std::size_t header_size = 32;
enum Type : std::uint32_t { doubles, integers, texts, one_double, one_integer, one_text };

constexpr std::size_t filled(std::size_t size) {
  return (size + 7) / 8 * 8;
}

/// FNV-1a of words of eight bytes: eight times as fast as of bytes.
std::uint64_t checksum(const std::byte *words, std::size_t size) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (std::size_t i = 0; i + 8 <= size; i += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, words + i, 8);
    hash = (hash ^ word) * 1099511628211ULL;
    hash ^= hash >> 32; // high bits of a word reach low ones
  }
  return hash;
}

void append(std::string &to, const void *bytes, std::size_t size) {
  if (size > 0) to.append(static_cast<const char *>(bytes), size);
  to.append(filled(size) - size, '\0');
}

template <class Number> std::string numbers(const Number *values, std::size_t count) {
  std::string bytes;
  append(bytes, values, count * sizeof(Number));
  return bytes;
}

std::string bytes_of(const std::string *values, std::size_t count) {
  std::string bytes;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t size = values[i].size();
    append(bytes, &size, 8);
    append(bytes, values[i].data(), values[i].size());
  }
  return bytes;
}

/// An entry behind its name.
std::string entry_of(const std::string &name, Type type, Index rows, Index columns,
                     const std::string &values) {
  const std::array<std::uint32_t, 2> head{type, static_cast<std::uint32_t>(name.size())};
  const std::array<std::uint64_t, 2> shape{static_cast<std::uint64_t>(rows),
                                           static_cast<std::uint64_t>(columns)};
  std::string bytes;
  append(bytes, head.data(), 8);
  append(bytes, shape.data(), 16);
  append(bytes, name.data(), name.size());
  return bytes + values;
}

/// Takes numbers and texts off the front of some bytes.
class Cursor {
public:
  Cursor(const std::byte *at, std::size_t left) : at_(at), left_(left) {}
  std::size_t left() const { return left_; }
  /// Null where there are not so many.
  const std::byte *take(std::uint64_t size) {
    if (size > left_ || filled(size) > left_) return nullptr;
    const std::byte *taken = at_;
    at_ += filled(size);
    left_ -= filled(size);
    return taken;
  }
  template <class Number> bool take_number(Number &number) {
    const std::byte *bytes = take(sizeof number);
    if (bytes != nullptr) std::memcpy(&number, bytes, sizeof number);
    return bytes != nullptr;
  }

private:
  const std::byte *at_;
  std::size_t left_;
};

/// The bytes of the values of an entry; nothing where they do not fit into what is left.
std::optional<std::size_t> size_of_values(std::uint32_t type, std::uint64_t count, Cursor at) {
  if (type > one_text || count > at.left()) return std::nullopt;
  if (type == doubles || type == one_double) return 8 * count;
  if (type == integers || type == one_integer) return 4 * count;
  const std::size_t all = at.left();
  for (std::uint64_t i = 0; i < count; ++i) {
    std::uint64_t size = 0;
    if (!at.take_number(size) || at.take(size) == nullptr) return std::nullopt;
  }
  return all - at.left();
}

std::vector<std::string> texts_in(const std::byte *values, std::size_t size, Index count) {
  std::vector<std::string> result;
  Cursor at(values, size);
  for (Index i = 0; i < count; ++i) {
    std::uint64_t length = 0;
    at.take_number(length);
    const auto *text = reinterpret_cast<const char *>(at.take(length)); // NOLINT: bytes of a text
    result.emplace_back(text, length);
  }
  return result;
}

template <class Number> std::vector<Number> numbers_in(const std::byte *values, Index count) {
  std::vector<Number> result(static_cast<std::size_t>(count));
  if (count > 0) std::memcpy(result.data(), values, result.size() * sizeof(Number));
  return result;
}

} // namespace

void ImageWriter::add(const std::string &name, const std::string &entry) {
  if (!entries_.emplace(name, entry).second)
    throw failure("the name '" + name + "' is taken in the image");
}

void ImageWriter::write(const std::string &name, const Matrix &value) {
  add(name, entry_of(name, doubles, value.rows(), value.cols(),
                     numbers(value.data(), static_cast<std::size_t>(value.size()))));
}

void ImageWriter::write(const std::string &name, const Vector &value) {
  write(name, Matrix(value));
}

void ImageWriter::write(const std::string &name, const std::vector<double> &value) {
  add(name, entry_of(name, doubles, std::ssize(value), 1, numbers(value.data(), value.size())));
}

void ImageWriter::write(const std::string &name, const std::vector<int> &value) {
  add(name, entry_of(name, integers, std::ssize(value), 1, numbers(value.data(), value.size())));
}

void ImageWriter::write(const std::string &name, const std::vector<std::string> &value) {
  add(name, entry_of(name, texts, std::ssize(value), 1, bytes_of(value.data(), value.size())));
}

void ImageWriter::write(const std::string &name, const std::string &value) {
  add(name, entry_of(name, one_text, 1, 1, bytes_of(&value, 1)));
}

void ImageWriter::write(const std::string &name, double value) {
  add(name, entry_of(name, one_double, 1, 1, numbers(&value, 1)));
}

void ImageWriter::write(const std::string &name, int value) {
  add(name, entry_of(name, one_integer, 1, 1, numbers(&value, 1)));
}

std::string ImageWriter::image(int schema) const {
  std::string image(header_size, '\0');
  for (const auto &[name, bytes] : entries_)
    image += bytes;
  const auto *data = reinterpret_cast<const std::byte *>(image.data()); // NOLINT: a text's bytes
  const std::array<std::uint64_t, 3> numbers{
      static_cast<std::uint64_t>(schema), image.size(),
      checksum(data + header_size, image.size() - header_size)};
  std::memcpy(image.data(), image_magic.data(), image_magic.size());
  std::memcpy(image.data() + image_magic.size(), numbers.data(), sizeof numbers);
  return image;
}

bool is_image(Bytes start) {
  return start.size() >= image_magic.size() &&
         std::memcmp(start.data(), image_magic.data(), image_magic.size()) == 0;
}

std::string guid_of(Bytes start) {
  if (!is_image(start) || start.size() < header_size)
    throw bad_input("this is no image of a model");
  std::array<std::uint64_t, 2> facts{}; // length and checksum
  std::memcpy(facts.data(), start.data() + header_size - sizeof facts, sizeof facts);
  char text[40];
  const auto part = [&](int i, int shift) { return static_cast<unsigned>(facts[i] >> shift); };
  std::snprintf(text, sizeof text, "{%08x-%04x-%04x-%04x-%04x%08x}", part(0, 0),
                part(0, 32) & 0xffff, part(0, 48), part(1, 48), part(1, 32) & 0xffff, part(1, 0));
  return text;
}

std::vector<std::byte> bytes_of_file(const std::filesystem::path &path, std::size_t most) {
  if (std::error_code ignored; std::filesystem::is_directory(path, ignored))
    throw bad_input(path.string() + " is a directory, not a model");
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = file ? std::streamoff(file.tellg()) : -1;
  std::vector<std::byte> bytes(std::min(most, size > 0 ? static_cast<std::size_t>(size) : 0));
  file.seekg(0);
  // NOLINTNEXTLINE: streams read characters
  if (size < 0 || !file.read(reinterpret_cast<char *>(bytes.data()), std::ssize(bytes)))
    throw bad_input(path.string() + " cannot be read" + system_reason());
  return bytes;
}

ImageReader::ImageReader(Bytes image, std::string what, int schema) : what_(std::move(what)) {
  if (!is_image(image)) throw bad_input(what_ + " is no image of a model of rbvi");
  std::array<std::uint64_t, 3> numbers{};
  if (image.size() < header_size) throw bad_input(what_ + " is truncated; copy or make it again");
  std::memcpy(numbers.data(), image.data() + image_magic.size(), sizeof numbers);
  const auto [version, length, sum] = numbers;
  if (image.size() < length)
    throw bad_input(what_ + " is truncated: " + std::to_string(image.size()) + " of " +
                    std::to_string(length) + " bytes; copy or make it again");
  const Error damaged = bad_input(what_ + " is damaged; copy or make it again");
  if (image.size() > length || image.size() % 8 != 0 ||
      checksum(image.data() + header_size, image.size() - header_size) != sum)
    throw damaged;
  if (version != static_cast<std::uint64_t>(schema))
    throw bad_input(what_ + " has schema version " + std::to_string(version) +
                    "; this build reads version " + std::to_string(schema) +
                    ": make it again by rbvi-online MODEL --pack FILE");
  Cursor at(image.data() + header_size, image.size() - header_size);
  while (at.left() > 0) {
    std::array<std::uint32_t, 2> head{};
    std::array<std::uint64_t, 2> shape{};
    if (!at.take_number(head) || !at.take_number(shape)) throw damaged;
    const std::byte *name = at.take(head[1]);
    const bool sane = shape[1] == 0 || shape[0] <= image.size() / shape[1];
    const std::optional<std::size_t> size =
        sane ? size_of_values(head[0], shape[0] * shape[1], at) : std::nullopt;
    if (name == nullptr || !size) throw damaged;
    const std::byte *values = at.take(*size);
    if (values == nullptr) throw damaged;
    entries_[{reinterpret_cast<const char *>(name), head[1]}] = // NOLINT: bytes of a text
        {static_cast<int>(head[0]), static_cast<Index>(shape[0]), static_cast<Index>(shape[1]),
         values, *size};
  }
}

const ImageReader::Entry &ImageReader::entry(const std::string &name, int type) const {
  const auto found = entries_.find(name);
  if (found == entries_.end()) throw bad_input(what_ + " has no '" + name + "'");
  if (found->second.type != type) throw bad_input(what_ + ": '" + name + "' is of another type");
  return found->second;
}

template <> Matrix ImageReader::read(const std::string &name) const {
  const Entry &of = entry(name, doubles);
  Matrix value(of.rows, of.columns);
  if (of.size > 0) std::memcpy(value.data(), of.values, of.size);
  return value;
}

template <> Vector ImageReader::read(const std::string &name) const {
  return Matrix(read<Matrix>(name)).reshaped();
}

template <> std::vector<double> ImageReader::read(const std::string &name) const {
  const Entry &of = entry(name, doubles);
  return numbers_in<double>(of.values, of.rows * of.columns);
}

template <> std::vector<int> ImageReader::read(const std::string &name) const {
  const Entry &of = entry(name, integers);
  return numbers_in<int>(of.values, of.rows * of.columns);
}

template <> std::vector<std::string> ImageReader::read(const std::string &name) const {
  const Entry &of = entry(name, texts);
  return texts_in(of.values, of.size, of.rows);
}

template <> std::string ImageReader::read(const std::string &name) const {
  const Entry &of = entry(name, one_text);
  return texts_in(of.values, of.size, 1).front();
}

template <> double ImageReader::read(const std::string &name) const {
  return numbers_in<double>(entry(name, one_double).values, 1).front();
}

template <> int ImageReader::read(const std::string &name) const {
  return numbers_in<int>(entry(name, one_integer).values, 1).front();
}

} // namespace rbvi
