#include "reader.hpp"

#include "rbvi/core/text.hpp"
#include "rbvi/element/axisymmetric_forms.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/element/facet_forms.hpp"
#include "rbvi/element/scalar_forms.hpp"

#include <algorithm>

namespace rbvi {

namespace {

/// "all" -> "".
std::vector<std::string> regions_in(const CaseNode &node) {
  std::vector<std::string> regions = names_in(entry(node, "at"));
  std::ranges::replace(regions, std::string("all"), std::string());
  return regions;
}

void add(std::vector<int> &positions, const std::vector<int> &more) {
  positions.insert(positions.end(), more.begin(), more.end());
  std::ranges::sort(positions);
  positions.erase(std::ranges::unique(positions).begin(), positions.end());
}

/// Of what is on the mapped domain.
std::vector<int> mapped_dependence(Reader &reader, const Formula &formula) {
  std::vector<int> positions = dependence_of_map(reader);
  add(positions, dependence_of(formula));
  return positions;
}

Factor lambda_factor(Reader &reader, const Expression &nu, bool plane_stress) {
  Factor factor = factor_of(reader, nu);
  factor.name = "lambda of " + factor.name;
  factor.value = lame_lambda(factor.value, plane_stress);
  return factor;
}

Factor shear_factor(Reader &reader, const Expression &nu) {
  Factor factor = factor_of(reader, nu);
  factor.name = "shear of " + factor.name;
  factor.value = lame_shear(factor.value);
  return factor;
}

Form stiffness(const std::string &region, const Named<Material> &material, const Scene &scene) {
  return scene.axisymmetric ? axisymmetric_elasticity(region, material, scene.degree)
                            : elasticity(region, material, scene.degree);
}

/// How a stiffness depends on the map, where it is exact: a similarity of the plane leaves it as it
/// is, of a body that is turned it is in proportion to the scale about a point of the axis. Empty:
/// the map changes more.
std::optional<std::vector<Factor>> factors_of_map(Reader &reader, const Scene &scene) {
  if (!scene.axisymmetric)
    return is_similarity(reader, scene) ? std::optional(std::vector<Factor>()) : std::nullopt;
  if (const CaseNode *scale = section(reader, "map").find("scale"))
    return std::vector{factor_of(reader, expression_in(reader, *scale))};
  return map_of(reader).empty() ? std::optional(std::vector<Factor>()) : std::nullopt;
}

/// Exact terms of a material on one region: E(mu, x) separates, nu is one number.
void add_exact_stiffness(Reader &reader, const std::vector<Product> &young, const Expression &nu,
                         const std::string &region, const std::vector<Factor> &of_map,
                         Scene &scene) {
  const bool plane_stress = section(reader, "physics").value == "plane_stress";
  for (const Product &product : young) {
    const Named<PointValue> at_point = point_value_of(formula_of(reader, {product.at_point}));
    const auto add = [&](const Named<Material> &material, const Factor &of_ratio) {
      std::vector<Factor> factors = product.factors;
      factors.push_back(of_ratio);
      factors.insert(factors.end(), of_map.begin(), of_map.end());
      scene.a.push_back(exact_term(stiffness(region, material, scene), factors));
    };
    add(lambda_alone(at_point), lambda_factor(reader, nu, plane_stress));
    add(shear_alone(at_point), shear_factor(reader, nu));
  }
}

/// Throws bad_input for a region that has a material already.
void check_new_material(const std::vector<std::string> &regions, const Scene &scene) {
  for (const BodyMaterial &other : scene.materials) {
    if (regions.empty() || other.regions.empty())
      throw bad_input("a material of all cells leaves none for another: name its regions");
    for (const std::string &region : regions)
      if (std::ranges::find(other.regions, region) != other.regions.end())
        throw bad_input("the region '" + region + "' has a material already");
  }
}

void read_material(Reader &reader, const CaseNode &node, Scene &scene) {
  const bool plane_stress = section(reader, "physics").value == "plane_stress";
  const Expression young = expression_in(reader, entry(node, "E")),
                   nu = expression_in(reader, entry(node, "nu"));
  limit(reader, young, young_range, scene);
  limit(reader, nu, poisson_range, scene);
  const Formula of_young = formula_of(reader, {young}), of_nu = formula_of(reader, {nu});
  if (nu.program().size() == 1) // lambda of a ratio that is a parameter is smooth in log(1 - 2 nu)
    for (const int position : dependence_of(of_nu))
      scene.coordinates[position] = {logarithm_to_half(), exponential_to_half()};
  const Named<Material> material =
      isotropic(point_value_of(of_young), point_value_of(of_nu), plane_stress);
  const std::vector<std::string> regions = regions_in(node);
  const bool whole = std::ranges::find(regions, "") != regions.end();
  const BodyMaterial own{whole ? std::vector<std::string>() : regions, material};
  check_new_material(own.regions, scene);
  scene.materials.push_back(own);
  const auto products = products_of(reader, young);
  const auto of_map = factors_of_map(reader, scene);
  for (const std::string &region : regions) {
    if (of_map && products && !depends_on_point(of_nu)) {
      add_exact_stiffness(reader, *products, nu, region, *of_map, scene);
      continue;
    }
    std::vector<int> positions = mapped_dependence(reader, of_young);
    add(positions, dependence_of(of_nu));
    scene.a.push_back(mapped_term(stiffness(region, material, scene), positions));
  }
}

/// Component c of a vector.
std::vector<Expression> along(const Expression &value, std::size_t c) {
  std::vector<Expression> components(c, parse_expression("0"));
  components.push_back(value);
  return components;
}

/// Loads of these components, form(function) on each part: exact where the domain does not move and
/// they separate.
template <class MakeForm>
void add_load(Reader &reader, const std::vector<Expression> &components, const MakeForm &form,
              Scene &scene) {
  std::vector<Term> exact;
  bool separates = map_of(reader).empty();
  for (std::size_t c = 0; separates && c < components.size(); ++c) {
    const auto products = products_of(reader, components[c]);
    separates = products.has_value();
    if (separates)
      for (const Product &product : *products)
        exact.push_back(
            exact_term(form(formula_of(reader, along(product.at_point, c))), product.factors));
  }
  if (separates) {
    scene.f.insert(scene.f.end(), exact.begin(), exact.end());
    return;
  }
  const Formula whole = formula_of(reader, components);
  scene.f.push_back(mapped_term(form(whole), mapped_dependence(reader, whole)));
}

/// -pressure n.
std::vector<Expression> traction_of_pressure(const Expression &pressure) {
  const std::string factor = "-(" + pressure.text() + ") * ";
  return {parse_expression(factor + "nx"), parse_expression(factor + "ny")};
}

void read_load(Reader &reader, const CaseNode &node, Scene &scene) {
  const CaseNode *force = node.find("force"), *pressure = node.find("pressure"),
                 *traction = node.find("traction");
  if (int(force != nullptr) + int(pressure != nullptr) + int(traction != nullptr) != 1)
    throw bad_input("a load is a force, a pressure or a traction");
  const CaseNode &given = force != nullptr ? *force : pressure != nullptr ? *pressure : *traction;
  std::vector<Expression> components = components_in(reader, given);
  if (pressure != nullptr) components = traction_of_pressure(components.front());
  if (components.size() != static_cast<std::size_t>(scene.components))
    throw bad_input("a load of " + counted(long(components.size()), "component") +
                    " on a displacement of " + std::to_string(scene.components));
  if (std::ranges::all_of(components, [&](const Expression &component) {
        return expanded(component, reader.lets).constant() == 0.0;
      }))
    return;
  for (const std::string &part : regions_in(node)) {
    const auto form = [&](const Formula &formula) {
      return force != nullptr ? body_load(part, point_map_of(formula), scene.components,
                                          scene.degree, scene.axisymmetric)
                              : traction_load(part, traction_of(formula), scene.components,
                                              scene.degree, scene.axisymmetric);
    };
    if (force == nullptr && part.empty())
      throw bad_input("pressures and tractions act on boundaries: name one");
    add_load(reader, components, form, scene);
  }
}

} // namespace

void read_physics(Reader &reader, Scene &scene, Defects &defects) {
  const CaseNode &physics = section(reader, "physics");
  const bool membrane = physics.value == "membrane";
  scene.dim = 2;
  scene.components = membrane ? 1 : 2;
  scene.axisymmetric = physics.value == "axisymmetric";
  if (membrane) {
    const Form form = laplace("", scene.degree);
    const auto of_map = factors_of_map(reader, scene);
    scene.a = {of_map ? exact_term(form, *of_map) : mapped_term(form, dependence_of_map(reader))};
  }
  const CaseNode &materials = section(reader, "materials");
  if (membrane != materials.entries.empty())
    defects.add(membrane ? materials : physics,
                membrane ? "a membrane has no materials" : "an elastic body needs 'materials:'");
  if (!membrane)
    for (const auto &[name, node] : materials.entries)
      defects.collect(node, [&, &value = node] { read_material(reader, value, scene); });
  for (const auto &[name, node] : section(reader, "loads").entries)
    defects.collect(node, [&, &value = node] { read_load(reader, value, scene); });
  scene.v_product = {exact_term(scene.axisymmetric
                                    ? axisymmetric_h1_product(1, scene.degree)
                                    : h1_product(1, scene.components, scene.degree))};
}

} // namespace rbvi
