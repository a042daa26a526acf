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

/// Of terms from `first` on, each over one of some parts, which may overlap: what parts share is of
/// the first of them alone.
void count_once(const std::vector<std::string> &parts, std::size_t first, Sum &terms) {
  for (; first < terms.size(); ++first) {
    Form &form = terms[first].form;
    const auto own = std::ranges::find(parts, form.region + form.boundary);
    form.without.assign(parts.begin(), own);
  }
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

/// E and nu, or Lame's constants, as they are written.
struct Constants {
  bool young = false; ///< first and second are E and nu, else lambda and mu
  bool plane_stress = false;
  Expression first, second;

  std::function<Material> material(Reader &reader) const;
  /// Of a strain that has no stress: swelling_modulus().
  Expression swelling() const;
};

std::function<Material> Constants::material(Reader &reader) const {
  const std::function<PointValue> one = point_value_of(formula_of(reader, {first})),
                                  other = point_value_of(formula_of(reader, {second}));
  return young ? isotropic(one, other, plane_stress) : of_lame(one, other, plane_stress);
}

Expression quotient(const std::string &over, const std::string &under) {
  return parse_expression("(" + over + ") / (" + under + ")");
}

Expression Constants::swelling() const {
  const std::string one = first.text(), other = second.text();
  if (young) return quotient(one, (plane_stress ? "1 - (" : "1 - 2*(") + other + ")");
  const std::string whole = "3*(" + one + ") + 2*(" + other + ")";
  if (!plane_stress) return parse_expression(whole);
  return quotient("2*(" + other + ")*(" + whole + ")", one + " + 2*(" + other + ")");
}

Constants constants_in(Reader &reader, const CaseNode &node, Scene &scene) {
  const bool young = node.find("lambda") == nullptr && node.find("mu") == nullptr;
  if (!young && (node.find("E") != nullptr || node.find("nu") != nullptr))
    throw bad_input("a material has E and nu, or lambda and mu");
  const Constants constants{young, section(reader, "physics").value == "plane_stress",
                            expression_in(reader, entry(node, young ? "E" : "lambda")),
                            expression_in(reader, entry(node, young ? "nu" : "mu"))};
  limit(reader, young ? constants.first : constants.second, young_range, scene);
  if (!young) return constants;
  const Expression &nu = constants.second;
  limit(reader, nu, poisson_range, scene);
  if (nu.program().size() == 1) // lambda of a ratio that is a parameter is smooth in log(1 - 2 nu)
    for (const int position : dependence_of(formula_of(reader, {nu})))
      scene.coordinates[position] = {logarithm_to_half(), exponential_to_half()};
  return constants;
}

/// One of Lame's constants as a modulus times a function of Poisson's ratio, where there is one.
struct Modulus {
  Expression value;
  std::optional<Factor> of_ratio{};
  bool shear = false;
};

std::array<Modulus, 2> moduli_of(Reader &reader, const Constants &constants) {
  const auto &[young, plane_stress, first, second] = constants;
  if (young) {
    Factor lambda = factor_of(reader, second), shear = lambda;
    lambda.name = "lambda of " + lambda.name;
    lambda.value = lame_lambda(lambda.value, plane_stress);
    shear.name = "shear of " + shear.name;
    shear.value = lame_shear(shear.value);
    return {Modulus{first, lambda}, Modulus{first, shear, true}};
  }
  const std::string one = first.text(), other = second.text();
  return {Modulus{plane_stress
                      ? quotient("2*(" + one + ")*(" + other + ")", one + " + 2*(" + other + ")")
                      : first},
          Modulus{second, {}, true}};
}

Form stiffness(const std::string &region, const std::function<Material> &material,
               const Scene &scene) {
  return scene.axisymmetric ? axisymmetric_elasticity(region, material, scene.degree)
                            : elasticity(region, material, scene.degree);
}

/// How a stiffness depends on the map, where it is exact: a similarity of the plane leaves it as it
/// is, of a body in space, or one that is turned, it is in proportion to the scale about a point
/// (of the axis). Empty: the map changes more.
std::optional<std::vector<Factor>> factors_of_map(Reader &reader, const Scene &scene) {
  if (!scene.axisymmetric && scene.dim == 2) {
    const bool stays = scene.components == 1 ? is_similarity(reader, scene)
                                             : keeps_directions(reader, scene); // of stresses
    return stays ? std::optional(std::vector<Factor>()) : std::nullopt;
  }
  if (const CaseNode *scale = section(reader, "map").find("scale"))
    return std::vector{factor_of(reader, expression_in(reader, *scale))};
  return map_of(reader).empty() ? std::optional(std::vector<Factor>()) : std::nullopt;
}

/// Exact terms of a material on each region; empty where it does not separate.
Sum exact_stiffness(Reader &reader, const Constants &constants,
                    const std::vector<std::string> &regions, const std::vector<Factor> &of_map,
                    const Scene &scene) {
  if (constants.young && depends_on_point(formula_of(reader, {constants.second}))) return {};
  const std::array<Modulus, 2> moduli = moduli_of(reader, constants);
  std::array<std::vector<Product>, 2> products;
  for (std::size_t m = 0; m < 2; ++m) {
    auto own = products_of(reader, moduli[m].value);
    if (!own) return {};
    products[m] = std::move(*own);
  }
  Sum terms;
  for (const std::string &region : regions)
    for (std::size_t k = 0; k < std::max(products[0].size(), products[1].size()); ++k)
      for (std::size_t m = 0; m < 2; ++m) {
        if (k >= products[m].size()) continue;
        const std::function<PointValue> at_point =
            point_value_of(formula_of(reader, {products[m][k].at_point}));
        std::vector<Factor> factors = products[m][k].factors;
        if (moduli[m].of_ratio) factors.push_back(*moduli[m].of_ratio);
        factors.insert(factors.end(), of_map.begin(), of_map.end());
        terms.push_back(exact_term(
            stiffness(region, moduli[m].shear ? shear_alone(at_point) : lambda_alone(at_point),
                      scene),
            factors));
      }
  return terms;
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

/// The load of a strain without stress: exact where the domain does not move and modulus and strain
/// separate.
void add_free_strain(Reader &reader, const Expression &modulus, const Expression &strain,
                     const std::vector<std::string> &regions, Scene &scene) {
  const auto moduli = products_of(reader, modulus), strains = products_of(reader, strain);
  const auto form = [&](const std::string &region, const Expression &one, const Expression &other) {
    return strain_load(region, point_value_of(formula_of(reader, {one})),
                       point_value_of(formula_of(reader, {other})), scene.dim, scene.degree,
                       scene.axisymmetric);
  };
  for (const std::string &region : regions) {
    if (!map_of(reader).empty() || !moduli || !strains) {
      std::vector<int> positions = mapped_dependence(reader, formula_of(reader, {modulus, strain}));
      scene.f.push_back(mapped_term(form(region, modulus, strain), positions));
      continue;
    }
    for (const Product &one : *moduli)
      for (const Product &other : *strains) {
        std::vector<Factor> factors = one.factors;
        factors.insert(factors.end(), other.factors.begin(), other.factors.end());
        scene.f.push_back(exact_term(form(region, one.at_point, other.at_point), factors));
      }
  }
}

void read_material(Reader &reader, const CaseNode &node, Scene &scene) {
  const Constants constants = constants_in(reader, node, scene);
  const std::vector<std::string> regions = regions_in(node);
  const bool whole = std::ranges::find(regions, "") != regions.end();
  BodyMaterial own{whole ? std::vector<std::string>() : regions, constants.material(reader)};
  check_new_material(own.regions, scene);
  const CaseNode *expansion = node.find("expansion"), *temperature = node.find("temperature");
  if ((expansion == nullptr) != (temperature == nullptr))
    throw bad_input("expansion and temperature belong together");
  if (expansion != nullptr) {
    const Expression strain =
        parse_expression("(" + expression_in(reader, *expansion).text() + ") * (" +
                         expression_in(reader, *temperature).text() + ")");
    own.free_strain = point_value_of(formula_of(reader, {strain}));
    const std::size_t first = scene.f.size();
    add_free_strain(reader, constants.swelling(), strain, regions, scene);
    count_once(regions, first, scene.f);
  }
  scene.materials.push_back(own);
  const auto of_map = factors_of_map(reader, scene);
  Sum terms;
  if (of_map) terms = exact_stiffness(reader, constants, regions, *of_map, scene);
  if (terms.empty()) {
    const std::vector<int> positions =
        mapped_dependence(reader, formula_of(reader, {constants.first, constants.second}));
    for (const std::string &region : regions)
      terms.push_back(mapped_term(stiffness(region, own.of_cell, scene), positions));
  }
  count_once(regions, 0, terms);
  scene.a.insert(scene.a.end(), terms.begin(), terms.end());
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
std::vector<Expression> traction_of_pressure(const Expression &pressure, int dim) {
  const std::string factor = "-(" + pressure.text() + ") * ";
  std::vector<Expression> traction{parse_expression(factor + "nx"),
                                   parse_expression(factor + "ny")};
  if (dim == 3) traction.push_back(parse_expression(factor + "nz"));
  return traction;
}

void read_load(Reader &reader, const CaseNode &node, Scene &scene) {
  const CaseNode *force = node.find("force"), *pressure = node.find("pressure"),
                 *traction = node.find("traction");
  if (int(force != nullptr) + int(pressure != nullptr) + int(traction != nullptr) != 1)
    throw bad_input("a load is a force, a pressure or a traction");
  const CaseNode &given = force != nullptr ? *force : pressure != nullptr ? *pressure : *traction;
  std::vector<Expression> components = components_in(reader, given);
  if (pressure != nullptr) components = traction_of_pressure(components.front(), scene.dim);
  if (components.size() != static_cast<std::size_t>(scene.components))
    throw bad_input("a load of " + counted(long(components.size()), "component") +
                    " on a displacement of " + std::to_string(scene.components));
  if (std::ranges::all_of(components, [&](const Expression &component) {
        return expanded(component, reader.lets).constant() == 0.0;
      }))
    return;
  const std::size_t first = scene.f.size();
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
  count_once(regions_in(node), first, scene.f);
}

/// Throws bad_input for a negative coefficient, with which a membrane may have no energy that is
/// least.
double checked_zeroth(double c, const std::string &where) {
  if (!(c >= 0))
    throw bad_input("zeroth: c of the term c u is " + short_number(c) + where +
                    ": it must not be negative");
  return c;
}

std::function<PointValue> checked_zeroth(std::function<PointValue> c) {
  return [c = std::move(c)](const FullMu &mu, const Point &x) {
    return checked_zeroth(c(mu, x), " at (" + short_number(x[0]) + ", " + short_number(x[1]) + ")");
  };
}

/// The term c u v: exact where the domain does not move and c is one product of factors and of a
/// function of the point.
void read_zeroth(Reader &reader, const CaseNode &node, Scene &scene) {
  if (scene.components != 1) throw bad_input("'zeroth' is of a membrane");
  const Expression c = expression_in(reader, node);
  const auto constant = expanded(c, reader.lets).constant();
  if (constant && checked_zeroth(*constant, "") == 0) return;
  const auto form = [&](const Expression &of) {
    return weighted_product("", checked_zeroth(point_value_of(formula_of(reader, {of}))),
                            scene.degree);
  };
  const auto products = map_of(reader).empty() ? products_of(reader, c) : std::nullopt;
  Term term = mapped_term(form(c), mapped_dependence(reader, formula_of(reader, {c})));
  if (products && products->size() == 1) {
    auto [factors, at_point] = products->front();
    for (Factor &factor : factors)
      factor.value = [value = factor.value, name = factor.name](const FullMu &mu) {
        return checked_zeroth(value(mu), " where " + name + " is that");
      };
    term = exact_term(form(at_point), factors);
  }
  term.of_order_zero = true;
  scene.a.push_back(std::move(term));
}

} // namespace

void read_physics(Reader &reader, Scene &scene, Defects &defects) {
  const CaseNode &physics = section(reader, "physics");
  const bool membrane = physics.value == "membrane";
  scene.components = membrane ? 1 : scene.dim;
  scene.axisymmetric = physics.value == "axisymmetric";
  if (membrane) {
    const Form form = laplace("", scene.degree);
    const auto of_map = factors_of_map(reader, scene);
    scene.a = {of_map ? exact_term(form, *of_map) : mapped_term(form, dependence_of_map(reader))};
  }
  if (const CaseNode &zeroth = section(reader, "zeroth"); !zeroth.value.empty())
    defects.collect(zeroth, [&] { read_zeroth(reader, zeroth, scene); });
  const CaseNode &materials = section(reader, "materials");
  if (membrane != materials.entries.empty())
    defects.add(membrane ? materials : physics,
                membrane ? "a membrane has no materials" : "an elastic body needs 'materials:'");
  if (!membrane)
    for (const auto &[name, node] : materials.entries)
      defects.collect(node, [&, &value = node] { read_material(reader, value, scene); });
  for (const auto &[name, node] : section(reader, "loads").entries)
    defects.collect(node, [&, &value = node] { read_load(reader, value, scene); });
  const CaseNode &length = section(reader, "v_length");
  defects.collect(length, [&] {
    scene.v_length = number_or(reader, reader.root, "v_length", 0);
    if (!(scene.v_length > 0 || length.value.empty())) throw bad_input("v_length is positive");
    scene.v_product = h1_product_of(scene, scene.v_length > 0 ? scene.v_length : 1);
  });
}

} // namespace rbvi
