#include "rbvi/element/imposed.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/element/lagrange.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

constexpr Index most_dofs = Index{3} * most_nodes; ///< of a cell

/// l at the dofs of a cell, and the dofs of a form.
using CellVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most_dofs, 1>;

/// Some part of the imposed values: at (mu, fixed boundary, x).
using Part = std::function<Point(const FullMu &, int, const Point &)>;

double product_of(const std::optional<std::vector<Factor>> &theta, const FullMu &mu) {
  double product = 1;
  for (std::size_t i = 0; theta && i < theta->size(); ++i)
    product *= (*theta)[i].value(mu);
  return product;
}

/// Whether fixed parameters make a value zero for all free ones.
bool vanishes(const ImposedTerm &term, const ParameterSpace &space) {
  if (!term.theta) return false;
  const SplitSum split = split_sum({exact_term({}, *term.theta)}, space);
  return split.exact.front().members.front().weight == 0;
}

/// An exact value of one boundary.
struct ExactValue {
  int boundary;
  const ImposedTerm *term;
};

std::vector<ExactValue> exact_values(const Scene &scene) {
  std::vector<ExactValue> result;
  for (std::size_t b = 0; b < scene.fixed.size(); ++b)
    for (const ImposedTerm &term : scene.fixed[b].values)
      if (term.theta) result.push_back({static_cast<int>(b), &term});
  return result;
}

bool has_mapped_values(const Scene &scene) {
  return std::ranges::any_of(scene.fixed, [](const FixedBoundary &boundary) {
    return std::ranges::any_of(boundary.values, [](const ImposedTerm &t) { return !t.theta; });
  });
}

/// The value of an exact term without its theta.
Part part_of(const ExactValue &value) {
  return
      [own = value.boundary, at = value.term->value](const FullMu &, int boundary, const Point &x) {
        return boundary == own ? at({}, x) : Point{};
      };
}

Point sum_of(const std::vector<ImposedTerm> &terms, bool with_exact, const FullMu &mu,
             const Point &x) {
  Point sum{};
  for (const ImposedTerm &term : terms) {
    if (term.theta && !with_exact) continue;
    const double theta = product_of(term.theta, mu);
    sum = sum + theta * term.value(term.theta ? FullMu{} : mu, x);
  }
  return sum;
}

/// All values together, or those that are not exact.
Part sum_part(const Scene &scene, bool with_exact) {
  return [fixed = scene.fixed, with_exact](const FullMu &mu, int boundary, const Point &x) {
    return sum_of(fixed[boundary].values, with_exact, mu, x);
  };
}

/// The nodes and components that a form of a scene has.
struct FormDofs {
  int dim, degree, components;
  Index count() const { return Index{nodes_per_cell(dim, degree)} * components; }
};

FormDofs dofs_of(const Scene &scene, const Form &form) {
  return {form.boundary.empty() ? scene.dim : scene.dim - 1, scene.degree, scene.components};
}

CellVector values_on(const FormDofs &dofs, const Part &part, const FullMu &mu, const Cell &cell) {
  const std::vector<Point> nodes = node_points(dofs.dim, dofs.degree, cell);
  CellVector result = CellVector::Zero(dofs.count());
  for (Index i = 0; i < result.size(); ++i)
    if (const int boundary = cell.imposed_by[i]; boundary >= 0) {
      const auto node = static_cast<std::size_t>(i / dofs.components);
      result[i] = part(mu, boundary, nodes[node])[i % dofs.components];
    }
  return result;
}

/// The cell that the kernel of a term is for: exact terms are integrals over the reference domain.
Cell cell_of(const Term &term, const Cell &cell) {
  Cell result = cell;
  if (term.theta) result.mapped = cell.reference;
  return result;
}

/// theta K l, K the values of a bilinear form on a cell.
CellVector times_values(const Term &a, const FormDofs &dofs, const CellVector &l, const FullMu &mu,
                        const Cell &cell) {
  std::array<double, most_dofs * most_dofs> k;
  a.form.kernel(mu, cell_of(a, cell), k.data());
  return product_of(a.theta, mu) * Eigen::Map<const Matrix>(k.data(), dofs.count(), dofs.count()) *
         l;
}

/// A kernel that is zero on cells without imposed values: make(mu, cell) of the others.
template <class Make> Form on_imposed(const Form &like, Index rows, Make make) {
  return {like.region,
          [rows, make](const FullMu &mu, const Cell &cell, double *values) {
            Eigen::Map<Vector> result(values, rows);
            if (cell.imposed_by == nullptr)
              result.setZero();
            else
              result = make(mu, cell);
          },
          like.boundary,
          {},
          like.without};
}

/// -a(l, v), a part of l and theta of a term of a in the kernel.
Form load_of(const Scene &scene, Term a, Part part) {
  const FormDofs dofs = dofs_of(scene, a.form);
  return on_imposed(a.form, dofs.count(), [a, part, dofs](const FullMu &mu, const Cell &cell) {
    return CellVector(-times_values(a, dofs, values_on(dofs, part, mu, cell), mu, cell));
  });
}

/// factor a(l, l'), parts of l.
Form work_of(const Scene &scene, Term a, Part one, Part other, double factor) {
  const FormDofs dofs = dofs_of(scene, a.form);
  return on_imposed(a.form, 1, [=](const FullMu &mu, const Cell &cell) {
    const CellVector l = values_on(dofs, one, mu, cell);
    const double work = l.dot(times_values(a, dofs, values_on(dofs, other, mu, cell), mu, cell));
    return CellVector(CellVector::Constant(1, factor * work));
  });
}

/// -f(v), theta of the term of f in the kernel; v at the dofs of a cell: at(mu, cell).
template <class At> auto work_at(const Term &f, const FormDofs &dofs, At at) {
  return [f, dofs, at](const FullMu &mu, const Cell &cell) {
    CellVector load(dofs.count());
    f.form.kernel(mu, cell_of(f, cell), load.data());
    return CellVector(CellVector::Constant(1, -product_of(f.theta, mu) * load.dot(at(mu, cell))));
  };
}

/// -f(l), a part of l.
Form work_of_load(const Scene &scene, const Term &f, Part part) {
  const FormDofs dofs = dofs_of(scene, f.form);
  return on_imposed(f.form, 1, work_at(f, dofs, [part, dofs](const FullMu &mu, const Cell &cell) {
                      return values_on(dofs, part, mu, cell);
                    }));
}

/// -f(v) of a displacement v(mu, x).
Form work_along(const Scene &scene, const Term &f, std::function<PointMap> v) {
  const FormDofs dofs = dofs_of(scene, f.form);
  const auto work = work_at(f, dofs, [v, dofs](const FullMu &mu, const Cell &cell) {
    const std::vector<Point> nodes = node_points(dofs.dim, dofs.degree, cell);
    CellVector at(dofs.count());
    for (Index i = 0; i < at.size(); ++i)
      at[i] = v(mu, nodes[i / dofs.components])[i % dofs.components];
    return at;
  });
  Form form = f.form;
  form.kernel = [work](const FullMu &mu, const Cell &cell, double *value) {
    *value = work(mu, cell)[0];
  };
  return form;
}

/// -f(e_c) of a term of f without its theta; of means the sum of the directions of the form.
Form work_along_axis(const Scene &scene, const Term &f, std::size_t c) {
  Point axis{};
  axis[c] = 1;
  if (f.form.kernel) return work_along(scene, f, everywhere(axis));
  Form form = f.form;
  for (Mean &mean : form.means)
    mean.direction = -mean.direction[c] * axis;
  return form;
}

/// The term without its theta.
Term without_theta(Term term) {
  term.theta = std::vector<Factor>{};
  return term;
}

std::vector<Factor> together(std::vector<Factor> factors, const std::vector<Factor> &others) {
  factors.insert(factors.end(), others.begin(), others.end());
  return factors;
}

/// Adds what factors, or a kernel, depend on; unset is all.
void add_parameters(const std::optional<std::vector<Factor>> &theta,
                    const std::optional<std::vector<int>> &of_kernel,
                    std::optional<std::vector<int>> &all) {
  if (!theta && !of_kernel) all.reset();
  if (!all) return;
  if (!theta) all->insert(all->end(), of_kernel->begin(), of_kernel->end());
  for (std::size_t i = 0; theta && i < theta->size(); ++i)
    all->insert(all->end(), (*theta)[i].parameters.begin(), (*theta)[i].parameters.end());
}

/// A term of a kernel that depends on what `term` and the imposed values depend on.
Term mapped_with(const Scene &scene, const Term &term, Form form) {
  std::optional<std::vector<int>> parameters = std::vector<int>{};
  add_parameters(term.theta, term.parameters, parameters);
  for (const FixedBoundary &boundary : scene.fixed)
    for (const ImposedTerm &value : boundary.values)
      add_parameters(value.theta, value.parameters, parameters);
  return mapped_term(std::move(form), std::move(parameters));
}

/// Of -a(l, v), one term of a.
void add_loads(const Scene &scene, const Term &a, Sum &loads) {
  if (a.theta)
    for (const ExactValue &value : exact_values(scene))
      loads.push_back(exact_term(load_of(scene, without_theta(a), part_of(value)),
                                 together(*a.theta, *value.term->theta)));
  if (!a.theta || has_mapped_values(scene))
    loads.push_back(mapped_with(scene, a, load_of(scene, a, sum_part(scene, !a.theta))));
}

} // namespace

std::vector<Point> node_points(int dim, int degree, const Cell &cell) {
  std::vector<Point> points(cell.reference.begin(), cell.reference.begin() + dim + 1);
  const auto count = static_cast<std::size_t>(nodes_per_cell(dim, degree));
  for (std::size_t e = 0; points.size() < count; ++e) {
    points.push_back((points[simplex_edges[e][0]] + points[simplex_edges[e][1]]) / 2);
  }
  return points;
}

bool imposes_values(const Scene &scene) {
  return std::ranges::any_of(scene.fixed, [](const FixedBoundary &b) { return !b.values.empty(); });
}

Scene with_imposed_loads(Scene scene) {
  for (FixedBoundary &boundary : scene.fixed)
    std::erase_if(boundary.values,
                  [&](const ImposedTerm &term) { return vanishes(term, scene.parameters); });
  std::erase_if(scene.f, [](const Term &term) { return term.of_imposed; });
  if (!imposes_values(scene)) return scene;
  Sum loads;
  for (const Term &a : scene.a)
    if (a.form.kernel) add_loads(scene, a, loads); // nothing is imposed where there are means
  for (Term &load : loads) {
    load.of_imposed = true;
    scene.f.push_back(std::move(load));
  }
  return scene;
}

namespace {

/// Component c of a translation.
Factor component_of(const Scene &scene, std::size_t c) {
  Factor factor{"component " + std::to_string(c) + " of the motion",
                [motion = scene.motion, c](const FullMu &mu) { return motion(mu, {})[c]; },
                {}};
  for (int p = 0; p < std::ssize(scene.parameters.all); ++p)
    factor.parameters.push_back(p);
  return factor;
}

/// Of -f(motion), one term of f.
void add_work_of_motion(const Scene &scene, const Term &f, Sum &energy) {
  if (!f.theta || !is_everywhere(scene.motion)) {
    if (!f.form.means.empty())
      throw bad_input("a force on a whole boundary, beside a motion that depends on the place: "
                      "impose displacements instead, and leave out 'motion:'");
    if (f.form.kernel) energy.push_back(mapped_term(work_along(scene, f, scene.motion)));
    return;
  }
  for (std::size_t c = 0; c < static_cast<std::size_t>(scene.components); ++c)
    energy.push_back(exact_term(work_along_axis(scene, without_theta(f), c),
                                together(*f.theta, {component_of(scene, c)})));
}

/// a(l, l) / 2 - f(l).
Sum energy_of_values(const Scene &scene) {
  Sum energy;
  if (!imposes_values(scene)) return energy;
  const bool exact = !has_mapped_values(scene);
  const std::vector<ExactValue> values = exact_values(scene);
  for (const Term &a : scene.a) {
    if (!a.form.kernel) continue;
    if (!a.theta || !exact) {
      const Part all = sum_part(scene, true);
      energy.push_back(mapped_with(scene, a, work_of(scene, a, all, all, 0.5)));
      continue;
    }
    for (std::size_t p = 0; p < values.size(); ++p)
      for (std::size_t q = 0; q <= p; ++q)
        energy.push_back(exact_term(
            work_of(scene, without_theta(a), part_of(values[p]), part_of(values[q]),
                    p == q ? 0.5 : 1),
            together(*a.theta, together(*values[p].term->theta, *values[q].term->theta))));
  }
  for (const Term &f : scene.f) {
    if (f.of_imposed || !f.form.kernel) continue;
    if (f.theta && exact)
      for (const ExactValue &value : values)
        energy.push_back(exact_term(work_of_load(scene, without_theta(f), part_of(value)),
                                    together(*f.theta, *value.term->theta)));
    else
      energy.push_back(mapped_with(scene, f, work_of_load(scene, f, sum_part(scene, true))));
  }
  for (Term &term : energy)
    term.of_imposed = true;
  return energy;
}

} // namespace

Sum imposed_energy(const Scene &scene) {
  Sum energy = energy_of_values(scene);
  for (const Term &f : scene.f)
    if (scene.motion && !f.of_imposed) add_work_of_motion(scene, f, energy);
  return energy;
}

Point imposed_value(const Scene &scene, const FullMu &all_parameters, int boundary,
                    const Point &x) {
  const FixedBoundary &fixed = scene.fixed[boundary];
  const Point value = sum_of(fixed.values, true, all_parameters, x);
  for (int c = 0; c < scene.components; ++c)
    if (!std::isfinite(value[c]))
      throw bad_input("the displacement imposed on the boundary '" + fixed.name +
                      "' is not finite at " + describe(scene.parameters, all_parameters));
  return value;
}

Vector imposed_values(const Scene &scene, const FullMu &all_parameters,
                      const std::vector<Point> &nodes, const std::vector<int> &imposed_by) {
  Vector result = Vector::Zero(std::ssize(imposed_by));
  for (std::size_t i = 0; i < imposed_by.size(); ++i)
    if (imposed_by[i] >= 0) {
      const std::size_t c = i % static_cast<std::size_t>(scene.components);
      result[i] = imposed_value(scene, all_parameters, imposed_by[i],
                                nodes[i / static_cast<std::size_t>(scene.components)])[c];
    }
  return result;
}

} // namespace rbvi
