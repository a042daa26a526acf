#include "gmsh_file.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/io/system_error.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <set>
#include <sstream>
#include <string_view>

namespace rbvi {

namespace {

bool is_space(char c) {
  return c == ' ' || c == '\n' || c == '\r' || c == '\t';
}

/// The bytes of a file that are still to be read: words, and numbers as text or in binary.
class Bytes {
public:
  explicit Bytes(std::string_view rest) : rest_(rest) {}
  void set_binary() { binary_ = true; }
  bool binary() const { return binary_; }
  void enter(std::string section) { section_ = std::move(section); }

  /// Up to the next white space; "" at the end.
  std::string_view word() {
    while (!rest_.empty() && is_space(rest_.front()))
      rest_.remove_prefix(1);
    const auto end = std::find_if(rest_.begin(), rest_.end(), is_space);
    return taken(end - rest_.begin());
  }
  template <class T> T text() {
    std::string_view digits = word();
    if (digits.starts_with('+')) digits.remove_prefix(1);
    T value{};
    const char *end = digits.data() + digits.size();
    const auto [last, error] = std::from_chars(digits.data(), end, value);
    if (error != std::errc() || last != end || digits.empty())
      throw bad_input(digits.empty() ? "it ends within " + section_
                                     : "'" + std::string(digits.substr(0, 40)) + "' in " +
                                           section_ + " is not the number that stands there");
    return value;
  }
  template <class T> T raw() {
    if (rest_.size() < sizeof(T)) throw bad_input("it ends within " + section_);
    T value;
    std::memcpy(&value, rest_.data(), sizeof value);
    rest_.remove_prefix(sizeof value);
    return value;
  }
  template <class T> T number() { return binary_ ? raw<T>() : text<T>(); }
  Point point() {
    Point x{};
    for (double &coordinate : x)
      coordinate = number<double>();
    return x;
  }
  /// A quoted name to the end of its line.
  std::string name() {
    const std::string_view line = taken(std::min(rest_.find('\n'), rest_.size()));
    const std::size_t open = line.find('"'), close = line.rfind('"');
    if (open == close) throw bad_input("a name in " + section_ + " is not quoted");
    return std::string(line.substr(open + 1, close - open - 1));
  }
  void pass_line_end() {
    if (!rest_.empty() && rest_.front() == '\r') rest_.remove_prefix(1);
    if (!rest_.empty() && rest_.front() == '\n') rest_.remove_prefix(1);
  }
  /// Passes over what stands before a word.
  void pass_to(const std::string &word) {
    const std::size_t found = rest_.find(word);
    if (found == std::string_view::npos) throw bad_input("it ends within " + section_);
    rest_.remove_prefix(found);
  }

private:
  std::string_view taken(std::size_t count) {
    const std::string_view result = rest_.substr(0, count);
    rest_.remove_prefix(count);
    return result;
  }
  std::string_view rest_;
  std::string section_ = "$MeshFormat";
  bool binary_ = false;
};

/// The dimension of an element type of Gmsh.
int dimension_of(int type) {
  switch (type) {
  case 15:
    return 0;
  case 1:
    return 1;
  case 2:
    return 2;
  case 4:
    return 3;
  case 3:
  case 5:
  case 6:
  case 7:
    throw bad_input("it has cells that are not triangles or tetrahedra: mesh without recombination "
                    "(Mesh.RecombineAll = 0)");
  default:
    throw bad_input("it has elements of order 2 or more (type " + std::to_string(type) +
                    " of Gmsh): write it with Mesh.ElementOrder = 1");
  }
}

enum class Version { two, four_zero, four_one };

/// Reads the sections of one file. An int is an int in each version; what Gmsh calls unsigned long
/// or size_t has eight bytes.
class Reader {
public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}
  GmshFile read();

private:
  using Key = std::pair<int, int>; ///< dimension, and number of an entity, or of a group in 2.2

  void read_format();
  void read_section(const std::string &name);
  void read_names();
  void read_entities();
  void read_nodes();
  void read_block_of_nodes();
  void read_elements_two();
  void read_elements_four();
  void finish();

  std::size_t count() { return bytes_.number<std::size_t>(); }
  int integer() { return bytes_.number<int>(); }
  /// A tag: an int but in 4.1. Throws for one below 1.
  std::size_t tag() {
    if (version_ == Version::four_one) return count();
    const int value = integer();
    if (value < 1) throw bad_input("node or element " + std::to_string(value) + " is below 1");
    return static_cast<std::size_t>(value);
  }
  void add_element(std::size_t number, int dim, int groups) {
    GmshElement element{number, dim, groups, {}};
    for (int i = 0; i <= dim; ++i)
      element.nodes[i] = tag();
    file_.elements.push_back(element);
  }
  int groups_of(const Key &key) {
    return lists_.try_emplace(key, static_cast<int>(lists_.size())).first->second;
  }
  void read_element_two(int type, std::size_t number, int tags);

  Bytes bytes_;
  Version version_ = Version::two;
  std::map<Key, std::vector<int>> entities_; ///< groups of each entity (4.x)
  std::map<Key, int> lists_;                 ///< index of the groups of each key
  GmshFile file_;
};

void Reader::read_format() {
  bytes_.word(); // $MeshFormat
  const auto version = bytes_.text<double>();
  const auto type = bytes_.text<int>();
  const auto size = bytes_.text<int>();
  if (version == 2.2)
    version_ = Version::two;
  else if (version == 4)
    version_ = Version::four_zero;
  else if (version == 4.1)
    version_ = Version::four_one;
  else
    throw bad_input("it is of MSH version " + short_number(version) +
                    ": 2.2, 4.0 and 4.1 are read (Mesh.MshFileVersion)");
  if (size != 8) throw bad_input("its numbers have " + std::to_string(size) + " bytes, not 8");
  if (type != 1) return;
  bytes_.set_binary();
  bytes_.pass_line_end();
  if (bytes_.raw<std::int32_t>() != 1)
    throw bad_input("it was written on a machine of another byte order: write it as text "
                    "(Mesh.Binary = 0)");
}

void Reader::read_names() {
  const auto names = bytes_.text<std::size_t>();
  for (std::size_t i = 0; i < names; ++i) {
    const int dim = bytes_.text<int>(), number = bytes_.text<int>();
    file_.names[{dim, number}] = bytes_.name();
  }
}

void Reader::read_entities() {
  std::array<std::size_t, 4> counts{};
  for (std::size_t &entities : counts)
    entities = count();
  for (int dim = 0; dim < 4; ++dim)
    for (std::size_t i = 0; i < counts[dim]; ++i) {
      const int entity = integer();
      (void)bytes_.point(); // the box of the entity; a point of 4.1 stands for itself
      if (dim > 0 || version_ == Version::four_zero) (void)bytes_.point();
      std::vector<int> &groups = entities_[{dim, entity}];
      const std::size_t own = count();
      for (std::size_t k = 0; k < own; ++k)
        groups.push_back(std::abs(integer())); // negative: the group turns the entity round
      const std::size_t bounding = dim > 0 ? count() : 0;
      for (std::size_t k = 0; k < bounding; ++k)
        (void)integer();
    }
}

void Reader::read_nodes() {
  const std::size_t blocks = version_ == Version::two ? bytes_.text<std::size_t>() : count();
  if (version_ == Version::two) {
    bytes_.pass_line_end();
    for (std::size_t i = 0; i < blocks; ++i) {
      const std::size_t number = tag();
      file_.nodes.push_back({number, bytes_.point()});
    }
    return;
  }
  for (int i = 0; i < (version_ == Version::four_one ? 3 : 1); ++i)
    (void)count(); // of all nodes; the least and the largest number
  for (std::size_t i = 0; i < blocks; ++i)
    read_block_of_nodes();
}

void Reader::read_block_of_nodes() {
  const int first = integer(), second = integer(), parametric = integer();
  const int dim = version_ == Version::four_one ? first : second;
  const std::size_t nodes = count(), begin = file_.nodes.size();
  const auto read_point = [&](GmshNode &node) {
    node.point = bytes_.point();
    for (int k = 0; parametric != 0 && k < dim; ++k)
      (void)bytes_.number<double>();
  };
  for (std::size_t i = 0; i < nodes; ++i) {
    file_.nodes.push_back({tag(), {}});
    if (version_ == Version::four_zero) read_point(file_.nodes.back());
  }
  for (std::size_t i = begin; version_ == Version::four_one && i < file_.nodes.size(); ++i)
    read_point(file_.nodes[i]);
}

/// The first tag is the physical group, the second the elementary entity, the third the number of
/// parts of a partition.
void Reader::read_element_two(int type, std::size_t number, int tags) {
  const int dim = dimension_of(type);
  int group = 0;
  for (int k = 0; k < tags; ++k) {
    const int value = integer();
    if (k == 0) group = std::abs(value);
    if (k == 2 && value > 0)
      throw bad_input("it is partitioned: write it without (rbvi spreads the mesh over its ranks)");
  }
  add_element(number, dim, groups_of({dim, group}));
}

void Reader::read_elements_two() {
  const auto all = bytes_.text<std::size_t>();
  bytes_.pass_line_end();
  for (std::size_t done = 0; done < all;) {
    if (!bytes_.binary()) {
      const std::size_t number = tag();
      const int type = integer(), tags = integer();
      read_element_two(type, number, tags);
      ++done;
      continue;
    }
    const int type = integer(), block = integer(), tags = integer();
    if (block < 1) throw bad_input("a block of $Elements is empty");
    for (int i = 0; i < block; ++i, ++done) {
      const std::size_t number = tag();
      read_element_two(type, number, tags);
    }
  }
}

void Reader::read_elements_four() {
  const std::size_t blocks = count();
  for (int i = 0; i < (version_ == Version::four_one ? 3 : 1); ++i)
    (void)count(); // of all elements; the least and the largest number
  for (std::size_t i = 0; i < blocks; ++i) {
    const int first = integer(), second = integer();
    const int dim = dimension_of(integer());
    const int entity = version_ == Version::four_one ? second : first;
    const std::size_t elements = count();
    for (std::size_t k = 0; k < elements; ++k) {
      const std::size_t number = tag();
      add_element(number, dim, groups_of({dim, entity}));
    }
  }
}

void Reader::read_section(const std::string &name) {
  if (name == "$PhysicalNames") return read_names();
  if (name == "$Nodes") return read_nodes();
  if (name == "$Elements")
    return version_ == Version::two ? read_elements_two() : read_elements_four();
  if (name == "$Entities" && version_ != Version::two) {
    bytes_.pass_line_end();
    return read_entities();
  }
  if (name == "$PartitionedEntities")
    throw bad_input("it is partitioned: write it without (rbvi spreads the mesh over its ranks)");
  bytes_.pass_to("$End" + name.substr(1));
}

/// Fills the lists of groups, sorts by number, and checks the nodes.
void Reader::finish() {
  file_.groups.resize(lists_.size());
  for (const auto &[key, index] : lists_) {
    std::vector<int> &groups = file_.groups[index];
    if (version_ != Version::two)
      groups = entities_[key];
    else if (key.second != 0)
      groups = {key.second};
  }
  const auto by_number = [](const auto &a, const auto &b) { return a.number < b.number; };
  std::sort(file_.nodes.begin(), file_.nodes.end(), by_number);
  std::stable_sort(file_.elements.begin(), file_.elements.end(), by_number);
  for (std::size_t i = 0; i < file_.nodes.size(); ++i) {
    const GmshNode &node = file_.nodes[i];
    if (i > 0 && node.number == file_.nodes[i - 1].number)
      throw bad_input("it has two nodes " + std::to_string(node.number));
    if (!std::all_of(node.point.begin(), node.point.end(),
                     [](double x) { return std::isfinite(x); }))
      throw bad_input("a coordinate of node " + std::to_string(node.number) + " is not finite");
  }
}

GmshFile Reader::read() {
  read_format();
  if (bytes_.word() != "$EndMeshFormat") throw bad_input("$MeshFormat does not end");
  std::set<std::string> seen;
  for (std::string name(bytes_.word()); !name.empty(); name = bytes_.word()) {
    if (name.front() != '$') throw bad_input("'" + name.substr(0, 40) + "' is not a section");
    if (!seen.insert(name).second && (name == "$Nodes" || name == "$Elements"))
      throw bad_input("it has two sections " + name);
    bytes_.enter(name);
    if (name == "$Nodes" || name == "$Elements") bytes_.pass_line_end();
    read_section(name);
    const std::string_view end = bytes_.word();
    if (end.empty()) throw bad_input("it ends within " + name);
    if (end != "$End" + name.substr(1))
      throw bad_input(name + " goes on where its counts let it end");
  }
  for (const char *needed : {"$Nodes", "$Elements"})
    if (!seen.contains(needed)) throw bad_input(std::string("it ends before ") + needed);
  finish();
  return std::move(file_);
}

std::string content_of(const std::string &file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw bad_input("cannot open mesh file '" + file + "'" + system_reason());
  std::ostringstream content;
  content << in.rdbuf();
  return content.str();
}

/// From the first section on that is no comment: Gmsh passes over those, and over a byte order
/// mark.
std::string_view without_comments(std::string_view rest) {
  const std::string_view mark = "\xef\xbb\xbf", end = "$EndComments";
  if (rest.starts_with(mark)) rest.remove_prefix(mark.size());
  for (;;) {
    rest.remove_prefix(std::min(rest.find_first_not_of(" \t\r\n"), rest.size()));
    const std::size_t at = rest.starts_with("$Comments") ? rest.find(end) : rest.npos;
    if (at == rest.npos) return rest;
    rest.remove_prefix(at + end.size());
  }
}

} // namespace

GmshFile read_gmsh_file(const std::string &file) {
  const std::string bytes = content_of(file);
  const std::string_view content = without_comments(bytes);
  if (content.starts_with("$NOD"))
    throw bad_input("mesh file '" + file +
                    "' is of MSH version 1: 2.2, 4.0 and 4.1 are read "
                    "(Mesh.MshFileVersion)");
  if (!content.starts_with("$MeshFormat"))
    throw bad_input("'" + file + "' is not a Gmsh mesh: it does not begin with $MeshFormat");
  try {
    return Reader(content).read();
  } catch (const Error &error) {
    throw bad_input("mesh file '" + file + "' cannot be read: " + error.what());
  }
}

} // namespace rbvi
