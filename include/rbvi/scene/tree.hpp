// A case as a tree: tables, lists and plain values, with the places where they stand in its file;
// and as text, a line "path: value" for each value, by which files keep it.
#pragma once

#include "rbvi/core/error.hpp"

#include <string>
#include <utility>
#include <vector>

namespace rbvi {

struct CaseNode {
  enum class Kind { value, list, table };
  Kind kind = Kind::value;
  std::string value; ///< as it is written, without quotes; "" for nothing
  std::vector<CaseNode> items;
  struct Entry;
  std::vector<Entry> entries;
  int line = 0, column = 0; ///< from 1; of an entry of a table that of its name

  bool is_value() const { return kind == Kind::value; }
  bool is_table() const { return kind == Kind::table; }
  /// Null where there is no such entry, or this is no table.
  const CaseNode *find(const std::string &name) const;
};

struct CaseNode::Entry {
  std::string name;
  CaseNode node;
};

/// Puts a value where the path "contact.support.friction" leads, tables made on the way; an empty
/// value takes away what is there. Returns false where the path leads through a value or a list.
bool replace(CaseNode &root, const std::string &path, const CaseNode &value);

/// The values under a node in their order, each by its path: "contact.floor.at" -> "bottom",
/// "contact.floor.against.plane.normal[0]" -> "0". Of an empty list the path ends with "[]", of an
/// empty table with "{}". A backslash is before a backslash, a dot, a colon, [ and { in names.
std::vector<std::pair<std::string, std::string>> values_of(const CaseNode &root);
/// values_of() as lines "path: value".
std::string text_of(const CaseNode &root);
/// The tree of such lines, without places. Throws bad_input, naming the line, for one that is none.
CaseNode tree_in(const std::string &text);

/// What a defect says of a value and of the line and the column at which it stands.
struct Defect {
  int line, column;
  std::string what;
};

/// All defects of a file, so that they are told at once.
class Defects {
public:
  explicit Defects(std::string file) : file_(std::move(file)) {}
  /// Of a place the first one counts.
  void add(const CaseNode &at, const std::string &what);
  /// `work()`; what it throws becomes a defect of that value.
  template <class Work> void collect(const CaseNode &at, Work &&work);
  bool none() const { return all_.empty(); }
  /// Throws bad_input if there are any: each a line, by their places.
  void throw_all() const;

private:
  std::string file_;
  std::vector<Defect> all_;
};

template <class Work> void Defects::collect(const CaseNode &at, Work &&work) {
  try {
    std::forward<Work>(work)();
  } catch (const Error &error) {
    add(at, error.what());
  }
}

} // namespace rbvi
