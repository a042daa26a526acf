#include "rbvi/fem/check_scene.hpp"

#include "rbvi/core/box.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/facets.hpp"
#include "rbvi/element/imposed.hpp"
#include "rbvi/fem/materials.hpp"
#include "rbvi/par/collective.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace rbvi {

namespace {

constexpr std::size_t sampled = 6; ///< cells, facets or nodes of each rank

/// So many of a list, from its beginning to its end.
template <class List> List some_of(const List &all) {
  List few;
  const std::size_t step = std::max<std::size_t>(1, all.size() / sampled);
  for (std::size_t i = 0; i < all.size() && few.size() < sampled; i += step)
    few.push_back(all[i]);
  return few;
}

/// A term and some of the cells, or facets, that it is an integral over; on some ranks none.
struct SampledTerm {
  const Scene &scene;
  const Term &term;
  std::string name; ///< "scene roller: term 1 of a"
  bool bilinear;
  std::vector<Cell> cells;
  Index rows() const {
    const int dim = term.form.boundary.empty() ? scene.dim : scene.dim - 1;
    return Index{nodes_per_cell(dim, scene.degree)} * scene.components;
  }
};

std::vector<Cell> cells_of(const Mesh &mesh, const Form &form) {
  std::vector<Cell> cells;
  if (!form.boundary.empty()) {
    for (const auto &[cell, facet] : some_of(mesh.facets.at(form.boundary)))
      cells.push_back(facet_cell(cell_of(mesh, cell), facet));
    return cells;
  }
  std::vector<std::size_t> numbers;
  for (std::size_t k = 0; k < mesh.cells.size(); ++k)
    if (form.region.empty() || mesh.region.at(form.region)[k]) numbers.push_back(k);
  for (const std::size_t k : some_of(numbers))
    cells.push_back(cell_of(mesh, k));
  return cells;
}

Cell mapped_at(const Scene &scene, const FullMu &mu, Cell cell) {
  for (int v = 0; v <= cell.dim; ++v)
    cell.mapped[v] =
        asked("the map of scene " + scene.name, [&] { return scene.map(mu, cell.reference[v]); });
  return cell;
}

/// What the kernel fills on a cell. Throws bad_input for another number of values than `count`.
Vector values_on(const SampledTerm &of, const FullMu &mu, const Cell &cell) {
  constexpr std::uint64_t untouched = 0x7ff8c0ffee123456; // no computation leaves this NaN
  std::vector<double> values(4096, std::bit_cast<double>(untouched));
  asked("the kernel of " + of.name, [&] { of.term.form.kernel(mu, cell, values.data()); });
  while (!values.empty() && std::bit_cast<std::uint64_t>(values.back()) == untouched)
    values.pop_back();
  const Index rows = of.rows(), count = of.bilinear ? rows * rows : rows;
  if (std::ssize(values) != count)
    throw bad_input(of.name + " fills " + std::to_string(values.size()) + " values where " +
                    counted(of.scene.components, "component") + " of degree " +
                    std::to_string(of.scene.degree) + " have " + std::to_string(count) +
                    ": give its form the components and the degree of the scene");
  const Vector result = Eigen::Map<const Vector>(values.data(), count);
  if (!result.allFinite())
    throw bad_input(of.name + " has a kernel whose values are not finite at " +
                    describe(of.scene.parameters, mu));
  return result;
}

/// Cells as they are mapped, or as if the map were the identity.
enum class On { reference, mapped };

/// On all sampled cells, one after the other.
Vector values_on_all(const SampledTerm &of, const FullMu &mu, On cells) {
  const Index rows = of.rows(), count = of.bilinear ? rows * rows : rows;
  Vector all(count * std::ssize(of.cells));
  for (std::size_t k = 0; k < of.cells.size(); ++k) {
    Cell cell = of.cells[k];
    if (cells == On::reference)
      cell.mapped = cell.reference;
    else
      cell = mapped_at(of.scene, mu, cell);
    all.segment(static_cast<Index>(k) * count, count) = values_on(of, mu, cell);
  }
  return all;
}

void check_symmetry(const SampledTerm &of, const Vector &all) {
  const Index rows = of.rows();
  for (Index k = 0; k < std::ssize(of.cells); ++k) {
    const Eigen::Map<const Matrix> values(all.data() + k * rows * rows, rows, rows);
    if (differ(Vector(values.reshaped()), Vector(values.transpose().reshaped())))
      throw bad_input(of.name + " is not symmetric");
  }
}

/// Whether one of the lists of a term holds a parameter.
bool declares(const Term &term, std::size_t parameter) {
  return depends_on({term}, static_cast<int>(parameter));
}

/// Calls visitor(parameter, mu with another value of it) for each that the term does not declare.
template <class Visitor>
void visit_undeclared(const SampledTerm &of, const FullMu &mu, Visitor &&visitor) {
  const ParameterSpace &space = of.scene.parameters;
  for (std::size_t i = 0; i < mu.size(); ++i)
    if (!declares(of.term, i)) visitor(space.all[i].name, with_other_value(space, mu, i));
}

void check_mapped(const SampledTerm &of, const FullMu &mu, const Vector &values) {
  visit_undeclared(of, mu, [&](const std::string &parameter, const FullMu &other) {
    if (differ(values_on_all(of, other, On::mapped), values))
      throw bad_input(of.name + " depends on the parameter " + parameter +
                      ", by its kernel or by the map, which its list of parameters lacks");
  });
}

/// The factor between two lists of values; nothing where one is no multiple of the other.
std::optional<double> ratio(const Vector &one, const Vector &other) {
  const double factor = one.dot(other) / other.squaredNorm();
  if (!((one - factor * other).lpNorm<Eigen::Infinity>() <= 1e-7 * one.lpNorm<Eigen::Infinity>()))
    return std::nullopt;
  return factor;
}

/// An exact kernel gets no parameters when it is assembled. `values`: on the reference cells.
void check_constant(const SampledTerm &of, const FullMu &mu, const Vector &values) {
  const ParameterSpace &space = of.scene.parameters;
  for (std::size_t i = 0; i < mu.size(); ++i)
    if (differ(values_on_all(of, with_other_value(space, mu, i), On::reference), values))
      throw bad_input(of.name + " is exact, and its kernel depends on the parameter " +
                      space.all[i].name + ": take that into a factor, or use mapped_term");
}

void check_exact(const SampledTerm &of, const FullMu &mu, const Vector &mapped) {
  const Vector values = values_on_all(of, mu, On::reference);
  check_constant(of, mu, values);
  if (values.isZero(0) && mapped.isZero(0)) return;
  const std::optional<double> by_map = ratio(mapped, values);
  if (!by_map)
    throw bad_input(of.name + " is exact, but the map deforms its cells: on them it is no multiple "
                              "of what it is on the reference domain; use mapped_term");
  visit_undeclared(of, mu, [&](const std::string &parameter, const FullMu &other) {
    const std::optional<double> here = ratio(values_on_all(of, other, On::mapped), values);
    if (!here || differ(*here, *by_map))
      throw bad_input(of.name + " is exact, but changes with the parameter " + parameter +
                      " by the map: give it a factor that declares this parameter, or use "
                      "mapped_term");
  });
}

/// A rigid motion leaves no force: K motion = 0.
void check_motion(const SampledTerm &of, const FullMu &mu, const Vector &mapped) {
  const Scene &scene = of.scene;
  if (!scene.motion) return;
  const Index rows = of.rows();
  const int dim = of.term.form.boundary.empty() ? scene.dim : scene.dim - 1;
  for (std::size_t k = 0; k < of.cells.size(); ++k) {
    const std::vector<Point> nodes = node_points(dim, scene.degree, of.cells[k]);
    Vector motion(rows);
    for (Index i = 0; i < rows; ++i)
      motion[i] = asked("the motion of scene " + scene.name, [&] {
        return scene.motion(mu, nodes[i / scene.components]);
      })[i % scene.components];
    const Eigen::Map<const Matrix> values(mapped.data() + static_cast<Index>(k) * rows * rows, rows,
                                          rows);
    const double force = (values * motion).lpNorm<Eigen::Infinity>();
    const double terms = (values.cwiseAbs() * motion.cwiseAbs()).lpNorm<Eigen::Infinity>();
    if (!(force <= 1e-9 * terms))
      throw bad_input(
          of.name + " does work with the motion of the scene, which must be one of a rigid "
                    "body and stretch no spring: impose it on a boundary (FixedBoundary::values)");
  }
}

void check_term(const SampledTerm &of, const FullMu &mu, bool of_product) {
  if (of.cells.empty()) return;
  const Vector mapped = values_on_all(of, mu, of_product ? On::reference : On::mapped);
  if (of.bilinear) check_symmetry(of, mapped);
  if (of_product) return;
  if (of.term.theta)
    check_exact(of, mu, mapped);
  else
    check_mapped(of, mu, mapped);
  if (of.bilinear) check_motion(of, mu, mapped);
}

/// `check(term on cells_of(form))` for those of a sum that a scene itself has.
template <class Cells, class Check>
void visit_terms(const Scene &scene, Cells &&cells, Check &&check) {
  for (const auto &[sum, name] :
       {std::pair{&scene.a, "a"}, {&scene.f, "f"}, {&scene.v_product, "the product of V"}})
    for (std::size_t i = 0; i < sum->size(); ++i)
      if (const Term &term = (*sum)[i]; !term.of_imposed && term.form.means.empty())
        check(SampledTerm{scene, term,
                          "scene " + scene.name + ": term " + std::to_string(i + 1) + " of " + name,
                          sum != &scene.f, cells(term.form)},
              sum == &scene.v_product);
}

/// The smallest |gap| of one interface where its normal points out of the body, and where into it.
struct Nearest {
  double outward = std::numeric_limits<double>::infinity(), inward = outward;
};

/// At the middle of a facet, the displacement zero.
void check_normal(const ContactInterface &interface, const FullMu &mu, const Cell &facet,
                  const std::string &what, Nearest &nearest) {
  const FacetMeasure measure = facet_measure(facet.dim, facet.mapped);
  Point x{};
  for (int i = 0; i < facet.dim; ++i)
    x = x + facet.reference[i] / facet.dim;
  PointConstraint at, nearer;
  const double step = 1e-3 * measure.size;
  try {
    at = asked(what, [&] { return interface.constraint_at(mu, x); });
    nearer = interface.constraint_at(mu, x, step * at.direction);
  } catch (const Error &error) {
    if (error.status() == Status::bad_input) throw;
    return; // no point is faced at this mu
  }
  const Point &n = at.direction;
  const double length = norm(n);
  if (!(std::abs(length - 1) <= 1e-6))
    throw bad_input(what + " has a normal of the length " + short_number(length) + " at (" +
                    short_number(x[0]) + ", " + short_number(x[1]) + "): it must be 1");
  double &of_side = dot(n, measure.normal) > 0 ? nearest.outward : nearest.inward;
  of_side = std::min(of_side, std::abs(at.gap));
  if (!interface.follows_state()) return;
  // gap = distance + direction . displacement
  const double closer = at.gap - (nearer.gap - step * dot(n, nearer.direction));
  if (!(std::abs(closer - step) <= 0.1 * step))
    throw bad_input(what + " has a normal that is no gradient of the distance to its surface at (" +
                    short_number(x[0]) + ", " + short_number(x[1]) + ")");
}

/// Of the interface of a body with something rigid along a curve.
Nearest nearest_of(const Problem &problem, std::size_t i) {
  const Scene &scene = problem.scene();
  const InterfaceEntities &entities = scene.contacts[i].entities;
  Nearest nearest;
  if (entities.kind == InterfaceEntities::Kind::cells || entities.parts.size() != 1) return nearest;
  const FullMu mu = generic_point(scene.parameters);
  const std::string what = "scene " + scene.name + ": " + described(scene.contacts[i]);
  for (const auto &[cell, facet] : some_of(problem.mesh().facets.at(entities.parts.front())))
    check_normal(*problem.contact().interfaces[i], mu,
                 mapped_at(scene, mu, facet_cell(cell_of(problem.mesh(), cell), facet)), what,
                 nearest);
  return nearest;
}

} // namespace

void check_exact_kernels(const Scene &scene) {
  const FullMu mu = generic_point(scene.parameters);
  Cell unit{scene.dim, {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {}};
  unit.mapped = unit.reference;
  visit_terms(
      scene, [&](const Form &) { return std::vector{unit}; },
      [&](const SampledTerm &term, bool) {
        if (term.term.theta) check_constant(term, mu, values_on_all(term, mu, On::reference));
      });
}

namespace {

/// Throws bad_input for a material that is none at a corner of the box.
void check_material(const Problem &problem, const std::vector<int> &of_cells) {
  const Scene &scene = problem.scene();
  const Mesh &mesh = problem.mesh();
  constexpr std::size_t few = 100;
  const std::size_t step = std::max<std::size_t>(1, mesh.cells.size() / few);
  for (const Mu &mu : corners_and_faces(scene.parameters)) {
    const FullMu all = expand(scene.parameters, mu);
    for (std::size_t k = 0; !scene.materials.empty() && k < mesh.cells.size(); k += step) {
      const BodyMaterial &material = scene.materials[of_cells.empty() ? 0 : of_cells[k]];
      while_doing("checking the material at " + describe(scene.parameters, mu),
                  [&] { (void)material.of_cell(all, reference_centre(cell_of(mesh, k))); });
    }
  }
}

/// Throws bad_input where the mesh does not end at a plane of symmetry, where the map or the motion
/// moves it, or where nodes can leave it. Collective.
void check_mirror(const Problem &problem, const MirrorPlane &plane) {
  const Scene &scene = problem.scene();
  const Dofs &dofs = problem.dofs();
  const auto c = static_cast<std::size_t>(plane.component);
  const FullMu mu = generic_point(scene.parameters);
  const std::vector<Point> &points = problem.mesh().points;
  const Vector imposed = imposed_values(scene, mu, points, dofs.imposed_by);
  std::vector<double> beyond{-1e300, -1e300}, found{0, 0}; // on both sides; moved, loose
  for (const Point &x : points) {
    beyond[0] = std::max(beyond[0], plane.position - x[c]);
    beyond[1] = std::max(beyond[1], x[c] - plane.position);
  }
  over_ranks(problem.comm(), MPI_MAX, beyond);
  const double round_off = 1e-7 * (beyond[0] + beyond[1]);
  const std::string axis(1, "xyz"[plane.component]),
      where = axis + " = " + short_number(plane.position);
  if (std::min(std::abs(beyond[0]), std::abs(beyond[1])) > round_off)
    throw bad_input("the mesh does not end at the plane of symmetry " + where +
                    ", but reaches from " + short_number(plane.position - beyond[0]) + " to " +
                    short_number(plane.position + beyond[1]) + ": mirror: {" + axis +
                    ": ...} names another plane");
  for (std::size_t node = 0; node < points.size(); ++node) {
    if (std::abs(points[node][c] - plane.position) > round_off) continue;
    found[0] = std::max(found[0], std::abs(scene.map(mu, points[node])[c] - plane.position));
    if (scene.components == 1) continue;
    if (scene.motion) found[0] = std::max(found[0], std::abs(scene.motion(mu, points[node])[c]));
    const std::size_t dof = node * static_cast<std::size_t>(scene.components) + c;
    if (dofs.free[dof] >= 0 || (imposed.size() > 0 && std::abs(imposed[dof]) > round_off))
      found[1] = 1;
  }
  over_ranks(problem.comm(), MPI_MAX, found);
  if (!(found[0] <= 10 * round_off))
    throw bad_input("the map or the motion moves the plane of symmetry " + where);
  if (found[1] > 0)
    throw bad_input("nodes on the plane of symmetry " + where + " can leave it: impose u" + axis +
                    ": 0 on the whole boundary that is there");
}

/// Throws bad_input where what the body meets is not its own image.
void check_faced(const Problem &problem, const MirrorPlane &plane, const FullMu &mu) {
  constexpr double askew = 1e-2; // of normals that should be in the plane
  for (const auto &interface : problem.contact().interfaces) {
    if (interface->entity_sum() == nullptr || interface->mesh().components == 1) continue;
    const std::vector<Point> &points = interface->dual().points;
    const Vector images = image_counts({plane}, points);
    for (std::size_t i = 0; i < points.size(); ++i)
      if (images[static_cast<Index>(i)] == 1 &&
          std::abs(interface->constraint_at(mu, points[i]).direction[plane.component]) > askew)
        throw bad_input(std::string("what the body meets at the plane of symmetry ") +
                        "xyz"[plane.component] + " = " + short_number(plane.position) +
                        " is not its own image: its normal leaves the plane there");
  }
}

} // namespace

void check_scene(const Problem &problem) {
  const Scene &scene = problem.scene();
  const FullMu mu = generic_point(scene.parameters);
  std::vector<double> outward, inward;
  for (const MirrorPlane &plane : scene.mirrors)
    check_mirror(problem, plane);
  collectively(problem.comm(), [&] {
    for (const MirrorPlane &plane : scene.mirrors)
      check_faced(problem, plane, mu);
  });
  const std::vector<int> materials = materials_of_cells(scene, problem.mesh());
  collectively(problem.comm(), [&] {
    check_material(problem, materials);
    visit_terms(
        scene, [&](const Form &form) { return cells_of(problem.mesh(), form); },
        [&](const SampledTerm &term, bool of_product) { check_term(term, mu, of_product); });
    for (std::size_t i = 0; i < scene.contacts.size(); ++i) {
      const Nearest nearest = nearest_of(problem, i);
      outward.push_back(nearest.outward);
      inward.push_back(nearest.inward);
    }
  });
  over_ranks(problem.comm(), MPI_MIN, outward);
  over_ranks(problem.comm(), MPI_MIN, inward);
  // Points far from a small rigid body may face it from behind, those next to it do not.
  for (std::size_t i = 0; i < inward.size(); ++i)
    if (inward[i] < outward[i])
      throw bad_input("scene " + scene.name + ": " + described(scene.contacts[i]) +
                      " has normals that point into the body: they must point out of it");
}

} // namespace rbvi
