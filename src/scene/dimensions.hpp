// Dimensions of what a case says, and the units of its parameters.
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

private:
  std::optional<Dimension> of(const CaseNode &node) const;
  std::map<std::string, Dimension> of_name_;
};

/// Without `units:` units are labels of one system. Defects: two of one dimension that are of
/// different sizes, and degrees.
void check_labels(const CaseNode &parameters, Defects &defects);

} // namespace rbvi
