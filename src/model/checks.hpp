// What is asked of a reduced model. Each throws failure, naming the member.
#pragma once

#include "rbvi/io/fields.hpp"

namespace rbvi {

void require(bool holds, const std::string &what);

/// The store that checks what a list says of its fields.
struct FieldChecker {
  static constexpr bool reads = false, checks = true;
  template <class T> void operator()(const std::string &, const T &) const {}
  void operator()(const std::string &name, const Matrix &matrix, Shape shape) const;
  void operator()(const std::string &name, const std::vector<int> &indices, Indices said) const;
  void operator()(const std::string &name, int value, Between said) const;
  template <class Holds> void ask(const std::string &what, Holds &&holds) const {
    require(holds(), what);
  }
};

} // namespace rbvi
