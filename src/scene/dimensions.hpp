#pragma once

#include "reader.hpp"

namespace rbvi {

/// Dimensions of expressions, as far as they are known: a number has any, and so has what it is
/// multiplied with, as 12 may be a length.
class Dimensions {
public:
  explicit Dimensions(const Reader &reader);
  /// Throws bad_input where values or lists have another dimension than `unit` ("": any), or add or
  /// compare what has different ones. What is no expression passes.
  void check(const CaseNode &node, const std::string &unit) const;

  /// Of a value; nothing where it has any. Throws bad_input as check().
  std::optional<Dimension> of(const CaseNode &node) const;

private:
  std::map<std::string, Dimension> of_name_;
};

} // namespace rbvi
