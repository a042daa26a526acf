// A case file as text: tables, lists and plain values with the places where they stand.
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

/// One document whose root is a table. Throws bad_input with the line of what YAML does not allow,
/// or reads as something else than meant: a name twice, a tab, a value over several lines.
CaseNode parse_document(const std::string &text, const std::string &file);

/// Puts a value where the path "contact.support.friction" leads, tables made on the way; an empty
/// value takes away what is there. Returns false where the path leads through a value or a list.
bool replace(CaseNode &root, const std::string &path, const CaseNode &value);

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
