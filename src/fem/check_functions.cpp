#include "rbvi/core/text.hpp"
#include "rbvi/fem/check_scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbvi {

namespace {

/// "scene roller: the factor 'lambda' of a"
std::string name_of(const Scene &scene, const Factor &factor, const std::string &owner) {
  return "scene " + scene.name + ": the factor '" + factor.name + "' of " + owner;
}

/// All factors of a scene, with what they are factors of.
std::vector<std::pair<const Factor *, std::string>> factors_of(const Scene &scene) {
  std::vector<std::pair<const Factor *, std::string>> all;
  const auto add = [&](const std::optional<std::vector<Factor>> &theta, const std::string &owner) {
    for (std::size_t i = 0; theta && i < theta->size(); ++i)
      all.emplace_back(&(*theta)[i], owner);
  };
  for (const auto &[sum, owner] : {std::pair{&scene.a, "a"}, {&scene.f, "f"}})
    for (const Term &term : *sum)
      if (!term.of_imposed) add(term.theta, owner);
  for (const FixedBoundary &boundary : scene.fixed)
    for (const ImposedTerm &value : boundary.values)
      add(value.theta, "what is imposed on '" + boundary.name + "'");
  return all;
}

void check_positions(const Scene &scene, const std::vector<int> &parameters,
                     const std::string &what) {
  for (const int i : parameters)
    if (i < 0 || i >= static_cast<int>(scene.parameters.all.size()))
      throw bad_input(what + " declares parameter number " + std::to_string(i) +
                      ", and the scene has " +
                      counted(std::ssize(scene.parameters.all), "parameter") + ", from 0 on");
}

/// NaN where the scene itself refuses these parameters.
double value_of(const Factor &factor, const FullMu &mu, const std::string &what) {
  return asked(what, [&] {
    try {
      return factor.value(mu);
    } catch (const Error &) {
      return std::numeric_limits<double>::quiet_NaN();
    }
  });
}

/// Whether both are numbers, and not the same.
bool are_different(double one, double other) {
  return std::isfinite(one) && std::isfinite(other) && differ(one, other);
}

void check_coordinate(const Coordinate &coordinate, double value, const std::string &what) {
  const double back = asked(what, [&] { return coordinate.back(coordinate.of(value)); });
  if (!std::isfinite(back) || differ(back, value))
    throw bad_input(what + " takes " + short_number(value) + " back to " + short_number(back) +
                    ": its two functions must be inverse to each other");
}

void check_factor(const Scene &scene, const Factor &factor, const std::string &owner) {
  const std::string what = name_of(scene, factor, owner);
  const FullMu mu = generic_point(scene.parameters);
  check_positions(scene, factor.parameters, what);
  const double value = value_of(factor, mu, what);
  for (std::size_t i = 0; i < mu.size(); ++i) {
    if (std::ranges::find(factor.parameters, static_cast<int>(i)) != factor.parameters.end())
      continue;
    if (are_different(value_of(factor, with_other_value(scene.parameters, mu, i), what), value))
      throw bad_input(what + " depends on the parameter " + scene.parameters.all[i].name +
                      ", which its list of parameters lacks");
  }
}

/// Factors of one name are taken for the same function.
void check_names(const Scene &scene) {
  const auto factors = factors_of(scene);
  const FullMu mu = generic_point(scene.parameters);
  for (const auto &[factor, owner] : factors)
    for (const auto &[other, other_owner] : factors) {
      if (factor->name != other->name) continue;
      const std::string what = name_of(scene, *factor, owner);
      const double one = value_of(*factor, mu, what), two = value_of(*other, mu, what);
      if (are_different(one, two))
        throw bad_input(what + " is " + short_number(one) + " where that of " + other_owner +
                        " is " + short_number(two) + ": give each function a name of its own");
    }
}

void check_terms(const Scene &scene, const Sum &sum, const std::string &name) {
  for (std::size_t i = 0; i < sum.size(); ++i) {
    const std::string what =
        "scene " + scene.name + ": term " + std::to_string(i + 1) + " of " + name;
    if (!sum[i].form) throw bad_input(what + " has no kernel");
    if (sum[i].parameters) check_positions(scene, *sum[i].parameters, what);
  }
}

/// What the value of an imposed term depends on: at some points, whether a boundary has them or
/// not.
void check_imposed_term(const Scene &scene, const ImposedTerm &term, const std::string &boundary) {
  if (!term.theta && !term.parameters) return;
  const std::string what =
      "scene " + scene.name + ": the displacement imposed on '" + boundary + "'";
  const std::vector<int> declared = term.theta ? std::vector<int>{} : *term.parameters;
  check_positions(scene, declared, what);
  const FullMu mu = generic_point(scene.parameters);
  for (const Point &x : {Point{0.3, 0.4, 0}, Point{-0.6, 0.5, 0}, Point{0.7, -0.8, 0}}) {
    const auto at = [&](const FullMu &all) {
      const Point value = asked(what, [&] { return term.value(all, x); });
      return Vector{{value[0], value[1], value[2]}};
    };
    for (std::size_t i = 0; i < mu.size(); ++i)
      if (std::ranges::find(declared, static_cast<int>(i)) == declared.end() &&
          at(mu).allFinite() && differ(at(with_other_value(scene.parameters, mu, i)), at(mu)))
        throw bad_input(
            what + " depends on the parameter " + scene.parameters.all[i].name +
            (term.theta ? ": take that into a factor" : ", which its list of parameters lacks"));
  }
}

} // namespace

bool differ(double one, double other) {
  return !(std::abs(one - other) <= 1e-9 * std::max(std::abs(one), std::abs(other)));
}

bool differ(const Vector &one, const Vector &other) {
  const double scale = std::max(one.lpNorm<Eigen::Infinity>(), other.lpNorm<Eigen::Infinity>());
  return !((one - other).lpNorm<Eigen::Infinity>() <= 1e-9 * scale);
}

FullMu with_other_value(const ParameterSpace &space, FullMu mu, std::size_t parameter) {
  const Parameter &p = space.all[parameter];
  double &value = mu[parameter];
  const double step = p.upper > p.lower ? 0.1 * (p.upper - p.lower) : 0.1;
  value += value + step <= p.valid.upper ? step : -step;
  return mu;
}

void check_functions(const Scene &scene) {
  const std::string name = "scene " + scene.name;
  if (!scene.map) throw bad_input(name + " has no map: without one, set identity()");
  if (scene.contacts.empty()) throw bad_input(name + " has no contact");
  for (const ContactRecipe &contact : scene.contacts)
    if (!contact.make || contact.entities.parts.empty())
      throw bad_input(name + " has a contact that no kind of contact made (obstacle(), ...)");
  if (scene.a.empty()) throw bad_input(name + " has no term in a");
  if (scene.v_product.empty()) throw bad_input(name + " has no product of V");
  for (const auto &[sum, of] :
       {std::pair{&scene.a, "a"}, {&scene.f, "f"}, {&scene.v_product, "the product of V"}})
    check_terms(scene, *sum, of);
  for (const auto &[factor, owner] : factors_of(scene))
    check_factor(scene, *factor, owner);
  check_names(scene);
  for (const auto &[parameter, coordinate] : scene.coordinates) {
    check_positions(scene, {parameter}, name + ": a coordinate");
    check_coordinate(coordinate, generic_point(scene.parameters)[parameter],
                     name + ": the coordinate of " + scene.parameters.all[parameter].name);
  }
  for (const FixedBoundary &boundary : scene.fixed)
    for (const ImposedTerm &term : boundary.values)
      check_imposed_term(scene, term, boundary.name);
  check_exact_kernels(scene);
}

} // namespace rbvi
