// Parameters, their box D, and sets of parameter values (training, validation, queries).
#pragma once

#include "rbvi/core/error.hpp"

#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace rbvi {

/// A point of the box: one value for each free parameter of a ParameterSpace. What users give, what
/// training sets and files hold.
struct Mu : std::vector<double> {
  using std::vector<double>::vector;
  explicit Mu(std::vector<double> values) : std::vector<double>(std::move(values)) {}
};

/// One value for each parameter, free or fixed: what the functions of a scene get (see expand).
struct FullMu : std::vector<double> {
  using std::vector<double>::vector;
};

/// A closed interval; by default all numbers.
struct Range {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
};

struct Parameter {
  std::string name;
  std::string unit; ///< "" when it has none
  double lower = 0, upper = 0;
  double value = 0; ///< used while the parameter is fixed
  Range valid{};    ///< where the scene makes sense: no box and no value may leave it
  /// Names of the values 0, 1, ..., which are all that it takes; empty: it is a number.
  std::vector<std::string> choices{};
};

/// The value that a parameter takes next to this one: of a choice a whole number.
double taken(const Parameter &parameter, double value);

/// A number in the unit of the parameter, or the name of a choice. Throws bad_input, which calls it
/// `what`.
double parse_value(const Parameter &parameter, const std::string &text, const std::string &what);

/// All parameters of a scene, and which of them are free.
struct ParameterSpace {
  std::vector<Parameter> all;
  std::vector<int> free; ///< indices into `all`, in the order of Mu

  int size() const { return static_cast<int>(free.size()); }
  const Parameter &at(int i) const { return all[free[i]]; }
};

/// Every parameter free.
ParameterSpace all_free(std::vector<Parameter> parameters);

/// Frees the named ones alone ("radius,center_x"), in this order. Throws bad_input for others.
ParameterSpace free_only(const ParameterSpace &space, const std::string &names);

/// The values of all parameters: `mu` for the free ones, `value` for the others.
FullMu expand(const ParameterSpace &space, const Mu &mu);

/// Whether each value lies in the box, to 1e-12 of its width.
bool in_box(const ParameterSpace &space, const Mu &mu);

/// Throws bad_input if mu has the wrong length, an entry that is not finite, or (unless
/// `allow_outside`) lies outside the box by more than 1e-12 of its width.
void check_mu(const ParameterSpace &space, const Mu &mu, bool allow_outside = false);

/// Reads "0.18,0.02,-0.01" (the free ones in order) or "radius=0.18,center_x=0" (the rest at
/// the default value), and checks it. Throws bad_input.
Mu parse_mu(const ParameterSpace &space, const std::string &text, bool allow_outside = false);

/// "radius,center_x": the free ones.
std::string names_of(const ParameterSpace &space);

/// Position among the free parameters.
std::optional<std::size_t> find_free(const ParameterSpace &space, const std::string &name);

/// What to throw for a name that is no free parameter.
Error unknown_parameter(const ParameterSpace &space, const std::string &name);

/// "radius=0.18 center_x=0.02": for messages.
std::string describe(const ParameterSpace &space, const Mu &mu);
std::string describe(const ParameterSpace &space, const FullMu &mu);

/// A finite decimal number that fills the whole text. Throws bad_input, naming `what`.
double parse_number(const std::string &text, const std::string &what);

/// "a,b,c" -> {"a", "b", "c"}; "" -> {}.
std::vector<std::string> split(const std::string &text, char separator);
/// Those with commas between them, without blanks around them.
std::vector<std::string> names_in(const std::string &text);

} // namespace rbvi
