#include "rbvi/core/functions.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/scene.hpp"

#include <cmath>

namespace rbvi {

namespace {

const auto log_maker = plain<NumberMap>("log", 1, [](double x) { return std::log(x); });
const auto exp_maker = plain<NumberMap>("exp", 1, [](double x) { return std::exp(x); });
const auto log_to_half_maker =
    plain<NumberMap>("log_to_half", 1, [](double x) { return std::log(1 - 2 * x); });
const auto exp_to_half_maker =
    plain<NumberMap>("exp_to_half", 1, [](double x) { return (1 - std::exp(x)) / 2; });

const Maker<Coefficient> affine_maker{
    "affine", 1, [](const Record &of) -> std::function<Coefficient> {
      return AffineCoefficient{number(of, "value"), number(of, "factor"),
                               static_cast<std::size_t>(integer(of, "parameter"))};
    }};

const Maker<PointMap> identity_maker =
    plain<PointMap>("identity", 1, [](const FullMu &, const Point &x) { return x; });

const Maker<Coefficient> constant_maker{"constant", 1,
                                        [](const Record &of) -> std::function<Coefficient> {
                                          return AffineCoefficient{number(of, "value")};
                                        }};

const Maker<PointValue> value_maker{
    "everywhere", 1, [](const Record &of) -> std::function<PointValue> {
      return [value = number(of, "value")](const FullMu &, const Point &) { return value; };
    }};

std::function<PointValue> value_of(const std::function<Coefficient> &coefficient) {
  return [coefficient](const FullMu &mu, const Point &) { return coefficient(mu); };
}

const Maker<PointValue> coefficient_maker{
    "of_parameters", 1,
    [](const Stored &of) { return value_of(made<Coefficient>(part(of, "coefficient"))); }};

std::function<PointMap> scaling(const std::function<Coefficient> &scale) {
  if (const auto *line = scale.target<AffineCoefficient>()) return Scaling{*line};
  return [scale](const FullMu &mu, const Point &x) { return scale(mu) * x; };
}

const Maker<PointMap> scaled_maker{
    "scaled", 1, [](const Stored &of) { return scaling(made<Coefficient>(part(of, "scale"))); }};

const Maker<PointMap> vector_maker{
    "everywhere", 1, [](const Record &of) -> std::function<PointMap> {
      const Point vector{number(of, "x"), number(of, "y"), number(of, "z")};
      return [vector](const FullMu &, const Point &) { return vector; };
    }};

/// Of components of any one type, the others zero.
template <class Number> std::function<PointMap> same_everywhere(std::vector<Number> components) {
  return [components = std::move(components)](const FullMu &mu, const Point &) {
    Point vector{};
    for (std::size_t c = 0; c < components.size(); ++c)
      vector[c] = components[c](mu);
    return vector;
  };
}

std::function<PointMap> vector_of(const std::vector<std::function<Coefficient>> &components) {
  std::vector<AffineCoefficient> lines;
  for (const auto &component : components)
    if (const auto *line = component.target<AffineCoefficient>()) lines.push_back(*line);
  if (lines.size() == components.size()) return same_everywhere(std::move(lines));
  return same_everywhere(components);
}

const Maker<PointMap> components_maker{
    "components", 1, [](const Stored &of) -> std::function<PointMap> {
      std::vector<std::function<Coefficient>> components;
      for (const auto &[name, record] : of.record.parts)
        components.push_back(made<Coefficient>(part(of, name)));
      if (components.size() > 3) throw bad_input("a vector of the file has four components");
      return vector_of(components);
    }};

const Maker<Material> material_maker{
    "everywhere", 1, [](const Record &of) -> std::function<Material> {
      const Lame material{number(of, "lambda"), number(of, "shear")};
      return [material](const FullMu &, const Point &) { return material; };
    }};

} // namespace

FunctionLibrary common_functions() {
  return {log_maker,         exp_maker,      log_to_half_maker, exp_to_half_maker, affine_maker,
          constant_maker,    identity_maker, value_maker,       vector_maker,      material_maker,
          coefficient_maker, scaled_maker,   components_maker};
}

template <class Signature> Named<Signature> made(const Stored &stored) {
  const Record &record = stored.record;
  const Maker<Signature> *other = nullptr;
  const FunctionLibrary none;
  for (const AnyMaker &any : stored.registry == nullptr ? none : stored.registry->functions)
    if (const auto *maker = std::get_if<Maker<Signature>>(&any);
        maker != nullptr && maker->name == record.name) {
      if (maker->version == record.version) return {maker->make(stored), record};
      other = maker;
    }
  throw bad_input(
      "function '" + record.name + "' version " + std::to_string(record.version) +
      " is not in this build" +
      (other == nullptr ? "" : ", which has version " + std::to_string(other->version)) +
      ": make the model again, or use the build that made it");
}

template Named<NumberMap> made(const Stored &);
template Named<Coefficient> made(const Stored &);
template Named<Check> made(const Stored &);
template Named<PointValue> made(const Stored &);
template Named<PointMap> made(const Stored &);
template Named<Surface> made(const Stored &);
template Named<Material> made(const Stored &);
template Named<Kernel> made(const Stored &);
template Named<Traction> made(const Stored &);
template Named<FieldValues> made(const Stored &);

Named<NumberMap> logarithm() {
  return log_maker();
}

Named<NumberMap> exponential() {
  return exp_maker();
}

Named<NumberMap> logarithm_to_half() {
  return log_to_half_maker();
}

Named<NumberMap> exponential_to_half() {
  return exp_to_half_maker();
}

Named<Coefficient> affine(double value, double factor, int index) {
  return affine_maker({{"value", {value}}, {"factor", {factor}}, {"parameter", {double(index)}}});
}

Named<Coefficient> parameter(int index) {
  return affine(0, 1, index);
}

Named<Coefficient> constant(double value) {
  return constant_maker({{"value", {value}}});
}

Named<PointMap> identity() {
  return identity_maker();
}

bool is_identity(const Named<PointMap> &map) {
  return map.record.name == identity_maker.name;
}

Named<PointValue> everywhere(double value) {
  return value_maker({{"value", {value}}});
}

Named<PointMap> everywhere(const Point &vector) {
  return vector_maker({{"x", {vector[0]}}, {"y", {vector[1]}}, {"z", {vector[2]}}});
}

Named<PointMap> everywhere(const std::vector<Named<Coefficient>> &components) {
  std::map<std::string, Record> parts;
  for (std::size_t c = 0; c < components.size(); ++c)
    parts[std::string(1, "xyz"[c])] = components[c].record;
  return components_maker.named(vector_of({components.begin(), components.end()}), {}, parts);
}

Named<PointValue> everywhere(const Named<Coefficient> &value) {
  return coefficient_maker.named(value_of(value), {}, {{"coefficient", value.record}});
}

Named<PointMap> scaled(const Named<Coefficient> &scale) {
  return scaled_maker.named(scaling(scale), {}, {{"scale", scale.record}});
}

Named<Material> everywhere(const Lame &material) {
  return material_maker({{"lambda", {material.lambda}}, {"shear", {material.shear}}});
}

} // namespace rbvi
