// What the sections of a case file are read with.
#pragma once

#include "rbvi/scene/tree.hpp"
#include "shapes.hpp"

#include "rbvi/core/formula.hpp"
#include "rbvi/core/units.hpp"

#include <optional>
#include <set>

namespace rbvi {

/// A case file with its changes while its scene is made.
///
/// Values of a parameter are in its unit wherever they are given, kept or printed (Mu, FullMu,
/// Parameter, files). What expressions see by its name is in the units of the case, and here alone
/// one becomes the other: by a let of that name, its value in its unit times what one of it is.
struct Reader {
  const CaseNode &root;
  std::optional<UnitSystem> units{};
  std::vector<Parameter> constants{}; ///< parameters without a range, among the first of the lets
  std::vector<Let> lets{};
  std::vector<std::string> parameters{}; ///< names, in the order of FullMu
  std::vector<std::string> values{};     ///< what formulas call their values in their units
  std::set<std::string> used{};          ///< parameters that some function depends on
  std::map<std::string, std::vector<Circle>> circles{}; ///< by boundary or region
};

/// The table of a section, empty if there is none.
const CaseNode &section(const Reader &reader, const std::string &name);

/// A number with a unit, or an expression. Throws bad_input with the column in the text.
Expression expression_in(const Reader &reader, const CaseNode &node);
/// The same without names. Throws bad_input where it is not finite.
double number_in(const Reader &reader, const CaseNode &node);
double number_or(const Reader &reader, const CaseNode &table, const std::string &name,
                 double otherwise);
/// Two, or as many as asked for.
std::vector<double> numbers_in(const Reader &reader, const CaseNode &list, std::size_t count);

/// As many as the space has dimensions, in the plane with 0 behind them.
Point vector_in(const Reader &reader, const CaseNode &list);

/// 3 of a solid, else 2.
int dimensions_of(const Reader &reader);

/// The text of an entry that is one of some. Throws bad_input.
std::string choice_or(const CaseNode &table, const std::string &name, const std::string &otherwise,
                      const std::vector<std::string> &choices);
/// yes, no, true or false.
bool is_yes(const CaseNode &node);
bool yes_or(const CaseNode &table, const std::string &name, bool otherwise);
/// A name, "a, b" or [a, b].
std::vector<std::string> names_in(const CaseNode &node);
/// An entry that must be there.
const CaseNode &entry(const CaseNode &table, const std::string &name);

/// What is this value by itself, a parameter or a constant, cannot leave the range.
void limit(Reader &reader, const Expression &value, const Range &range, Scene &scene);

/// Whether an expression may be this name alone: not pi, and, a number.
bool is_name(const std::string &text);
/// Whether a parameter has one value, neither a range nor a choice.
bool is_constant(const CaseNode &parameter);
/// That of the numbers of a parameter: its `unit`, else that of the first of them that has one.
std::string unit_of(const CaseNode &parameter);
/// How many of the unit of the case one of a unit is; without units of the case 1.
double size_of(const Reader &reader, const std::string &unit);
/// A number in the unit of a parameter or of an output ("": that of the case): without names and a
/// unit it is in that unit, with names in the units of the case.
double number_in(const Reader &reader, const CaseNode &node, const std::string &unit);
/// Two.
Range range_in(const Reader &reader, const CaseNode &list, const std::string &unit);

/// Of some expressions; the parameters that they depend on count as used.
Formula formula_of(Reader &reader, std::vector<Expression> values);
Formula formula_in(Reader &reader, const CaseNode &node);
/// The components of a list, or of a single value the first.
std::vector<Expression> components_in(const Reader &reader, const CaseNode &node);

/// A factor that is an expression in parameters alone.
Factor factor_of(Reader &reader, const Expression &value);

/// A function as sum of products: factors in parameters and functions of the point, lets written
/// out; empty where it does not separate.
struct Product {
  std::vector<Factor> factors; ///< none: 1
  Expression at_point;
};
std::optional<std::vector<Product>> products_of(Reader &reader, const Expression &value);

/// An entry of `springs`: it pulls the first boundary against the direction of the first mean with
/// stiffness m(u) + preload, m the sum of the means.
struct Spring {
  std::vector<Mean> means;
  std::optional<Expression> stiffness;
  std::optional<std::string> preload; ///< an expression
};
Spring spring_in(const Reader &reader, const CaseNode &node, const Scene &scene);

/// What the domain has of a force or a stiffness that is given of the whole body.
Expression share_of_domain(const Scene &scene, const Expression &value);
/// Throws bad_input, naming what has this direction, where it crosses a plane of symmetry.
void check_direction(const Scene &scene, const Point &direction, const std::string &what);

/// Sections, in the order in which they depend on each other. They throw bad_input, or collect
/// defects one by one.
void read_parameters(Reader &reader, Scene &scene, Defects &defects);
void read_mesh(Reader &reader, Scene &scene, Defects &defects);
/// Of the mesh from a file: what its parts must be.
void read_facts(const Reader &reader, const CaseNode &mesh, MeshRecipe &recipe, Defects &defects);
void read_motion(Reader &reader, Scene &scene, Defects &defects);
void read_physics(Reader &reader, Scene &scene, Defects &defects);
/// After the physics.
void read_symmetry(const Reader &reader, Scene &scene, Defects &defects);
/// After the symmetry.
void read_springs(Reader &reader, Scene &scene, Defects &defects);
void read_contact(Reader &reader, Scene &scene, Defects &defects);
/// After contact.
void read_outputs(Reader &reader, Scene &scene, Defects &defects);

/// Whether an output is over contacts: where its places are their names, or there are none.
bool is_over_contacts(const Reader &reader, const CaseNode &output);

/// Defaults outside of their limits and of those that what they are gives them. After
/// all sections.
void check_limits(const Reader &reader, const Scene &scene, Defects &defects);

/// Known answers. After all limits.
void read_tests(const Reader &reader, Scene &scene, Defects &defects);

/// Positions of the parameters that the map depends on.
std::vector<int> dependence_of_map(Reader &reader);
/// The components of the map; none: the identity.
std::vector<Expression> map_of(const Reader &reader);
/// Whether the map is a similarity wherever it is smooth, at random points and parameters.
bool is_similarity(const Reader &reader, const Scene &scene);
/// Whether it is one without a rotation: normals of the mesh are those of the mapped body.
bool keeps_directions(const Reader &reader, const Scene &scene);

/// Unknown names, shapes and expressions of the whole file.
void check_keys(const Reader &reader, Defects &defects);

} // namespace rbvi
