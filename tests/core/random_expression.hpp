// Random expressions as texts, and the round-off of their values.
#pragma once

#include "rbvi/core/expression.hpp"

#include <random>
#include <string>
#include <vector>

namespace rbvi {

/// In our language and in muParser's, with the parentheses that are needed and some more.
struct RandomText {
  std::string ours, theirs;
  int binds; ///< 0: loosest, a choice; 9: an operand
};

class RandomExpressions {
public:
  RandomExpressions(unsigned seed, std::vector<std::string> names)
      : random(seed), names_(std::move(names)) {}
  RandomText number(int depth);
  RandomText truth(int depth); ///< 0 or 1
  std::mt19937 random;
  int pick(int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); }
  template <class Choices> const auto &one_of(const Choices &choices) {
    return choices[static_cast<std::size_t>(pick(static_cast<int>(choices.size())))];
  }

  RandomText joined(const RandomText &a, const std::string &operation, const RandomText &b);
  RandomText chosen(const RandomText &condition, const RandomText &a, const RandomText &b);

private:
  /// In parentheses if it binds too loosely, and sometimes if not.
  RandomText operand(RandomText text, int binds_at_least);
  RandomText leaf();
  std::vector<std::string> names_;
};

/// A value, and a bound for its round-off: each operation at what its operands may be. Infinite if
/// a branch, a jump or the end of a domain is as near, where the sign of a zero decides, and where
/// muParser takes NaN otherwise.
struct BoundedValue {
  double value, error;
  bool all_finite = true; ///< with every value on the way
};
/// `values`: by position in the names of the expression.
BoundedValue bounded(const Expression &expression, const std::vector<double> &values);

} // namespace rbvi
