#include "rbvi/element/output_cells.hpp"

#include "rbvi/element/cell_fields.hpp"
#include "rbvi/element/facets.hpp"
#include "rbvi/element/lagrange.hpp"
#include "rbvi/element/output_sums.hpp"
#include "rbvi/element/quadrature.hpp"
#include "rbvi/element/simplex_lines.hpp"

#include <cmath>

namespace rbvi {

namespace {

using OutputPart = OutputCells::Part;

int per_cell(const Scene &scene) {
  return nodes_per_cell(scene.dim, scene.degree);
}

const int *nodes_of_cell(const Scene &scene, const OutputCells &cells, int cell) {
  return cells.cells.data() + Index{cell} * per_cell(scene);
}

/// Not mapped.
Cell reference_cell(const Scene &scene, const OutputCells &cells, int number) {
  Cell cell{scene.dim, {}, {}};
  for (int i = 0; i <= scene.dim; ++i)
    for (Index k = 0; k < cells.points.cols(); ++k)
      cell.reference[i][k] = cells.points(nodes_of_cell(scene, cells, number)[i], k);
  return cell;
}

/// Cells with a displacement at one mu.
struct OutputState {
  const Scene &scene;
  const FullMu &mu;
  const OutputCells &cells;
  const Vector &u;

  const int *nodes(int cell) const { return nodes_of_cell(scene, cells, cell); }
  Cell cell(int number) const {
    Cell cell = reference_cell(scene, cells, number);
    map_cell(scene, mu, cell);
    return cell;
  }
  /// With the motion.
  Point at_node(int node) const {
    Point value{};
    if (scene.motion) {
      Point x{};
      for (Index k = 0; k < cells.points.cols(); ++k)
        x[k] = cells.points(node, k);
      value = scene.motion(mu, x);
    }
    for (int c = 0; c < scene.components; ++c)
      value[c] += u[Index{node} * scene.components + c];
    return value;
  }
  DisplacedCell displaced(int number) const {
    DisplacedCell result{cell(number), cells.materials.empty() ? 0 : cells.materials[number], {}};
    for (int i = 0; i < per_cell(scene); ++i)
      result.u[i] = at_node(nodes(number)[i]);
    return result;
  }
};

OutputFields fields_at(const Scene &scene, const FullMu &mu, const DisplacedCell &cell,
                       const Barycentric &at) {
  OutputFields fields;
  fields.fill(std::numeric_limits<double>::quiet_NaN());
  const Point x = point_at(cell.cell.mapped, at, scene.dim + 1),
              u = displacement_at(scene, cell, at);
  const auto dim = static_cast<std::size_t>(scene.dim);
  std::copy_n(x.begin(), dim, fields.begin() + field::x);
  if (scene.components == 1) {
    fields[field::u] = u[0];
    const Point slope = slope_at(scene, cell, at);
    fields[field::slope_x] = slope[0];
    fields[field::slope_y] = slope[1];
    return fields;
  }
  std::copy_n(u.begin(), dim, fields.begin() + field::ux);
  if (scene.materials.empty()) return fields;
  const PointStress stress = stress_at(scene, mu, cell, at);
  const auto &s = stress.sigma;
  fields[field::sigma_xx] = s(0, 0);
  fields[field::sigma_yy] = s(1, 1);
  fields[field::sigma_zz] = s(2, 2);
  fields[field::sigma_xy] = s(0, 1);
  if (dim == 3) {
    fields[field::sigma_yz] = s(1, 2);
    fields[field::sigma_xz] = s(0, 2);
  }
  const Eigen::Matrix3d deviator = s - s.trace() / 3 * Eigen::Matrix3d::Identity();
  fields[field::von_mises] = std::sqrt(1.5) * deviator.norm();
  fields[field::strain_energy] = stress.strain_energy;
  return fields;
}

/// Of the cell, from those of the first vertices of one of its facets.
Barycentric on_facet(int dim, int facet, const Barycentric &of_facet) {
  const std::vector<int> vertices = facet_nodes(dim, 1, facet);
  Barycentric at{};
  for (std::size_t i = 0; i < vertices.size(); ++i)
    at[vertices[i]] = of_facet[i];
  return at;
}

/// The cell, or a facet of it, where its normal is known.
void add_simplex(const OutputState &state, const OutputPart &part, OutputLines &lines) {
  const DisplacedCell cell = state.displaced(part.cell);
  const int dim = state.scene.dim;
  const bool whole = part.facet < 0;
  FacetMeasure facet{};
  if (!whole) facet = facet_measure(dim, facet_cell(cell.cell, part.facet).mapped);
  const int own_dim = whole ? dim : dim - 1;
  const double size = whole ? volume_of(dim, cell.cell.mapped) : facet.size;
  const auto fields_of = [&](const Barycentric &at) {
    OutputFields fields =
        fields_at(state.scene, state.mu, cell, whole ? at : on_facet(dim, part.facet, at));
    if (!whole) std::copy_n(facet.normal.begin(), dim, fields.begin() + field::nx);
    return fields;
  };
  add_simplex(
      own_dim, size, fields_of,
      [&](const OutputFields &fields) {
        return circumference(state.scene.axisymmetric, {fields[field::x], 0, 0});
      },
      lines);
}

void add_point(const OutputState &state, const OutputPart &part, const Point &point,
               OutputLines &lines) {
  const DisplacedCell cell = state.displaced(part.cell);
  const Barycentric at = barycentric_of(state.scene.dim, cell.cell.reference, point);
  lines.add(
      1, [&](std::size_t, double) { return fields_at(state.scene, state.mu, cell, at); },
      [](std::size_t, const OutputFields &) { return 1.0; });
}

/// Of a, then of f.
const Term &term_of(const Scene &scene, int number) {
  return number < std::ssize(scene.a) ? scene.a[number] : scene.f[number - std::ssize(scene.a)];
}

/// Values of a kernel of a or f on a part, and what belongs to its rows.
struct LocalForm {
  std::vector<double> values;
  std::vector<int> nodes; ///< positions in the cell
};

LocalForm local_form(const Scene &scene, const FullMu &mu, const OutputCells &cells,
                     const OutputPart &part, bool bilinear) {
  const Term &term = term_of(scene, part.term);
  Cell cell = reference_cell(scene, cells, part.cell);
  if (!term.theta) map_cell(scene, mu, cell);
  LocalForm local;
  if (part.facet < 0)
    for (int i = 0; i < per_cell(scene); ++i)
      local.nodes.push_back(i);
  else
    local.nodes = facet_nodes(scene.dim, scene.degree, part.facet);
  Cell of_kernel = part.facet < 0 ? cell : facet_cell(cell, part.facet);
  if (term.theta) of_kernel.mapped = of_kernel.reference;
  const std::size_t rows = local.nodes.size() * static_cast<std::size_t>(scene.components);
  local.values.resize(bilinear ? rows * rows : rows);
  term.form.kernel(term.theta ? FullMu{} : mu, of_kernel, local.values.data());
  return local;
}

/// a(u, l) or -f(l) on a part, without the factor of the term: row . u + given.
struct Tested {
  std::vector<std::pair<Index, double>> row; ///< by positions in u
  double given = 0;
};

Tested tested(const Scene &scene, const FullMu &mu, const OutputCells &cells,
              const OutputPart &part, const Point &direction) {
  const bool bilinear = part.term < std::ssize(scene.a);
  const LocalForm local = local_form(scene, mu, cells, part, bilinear);
  const auto components = static_cast<std::size_t>(scene.components);
  const std::size_t rows = local.nodes.size() * components;
  Tested result;
  for (std::size_t j = 0; bilinear && j < rows; ++j)
    result.row.emplace_back(
        Index{nodes_of_cell(scene, cells, part.cell)[local.nodes[j / components]]} *
                scene.components +
            static_cast<Index>(j % components),
        0);
  for (std::size_t i = 0; i < rows; ++i) {
    const int held = (part.held >> local.nodes[i / components]) & 1;
    const double l = held * direction[i % components];
    if (l == 0) continue;
    if (!bilinear) result.given -= l * local.values[i];
    for (std::size_t j = 0; bilinear && j < rows; ++j)
      result.row[j].second += l * local.values[i * rows + j];
  }
  return result;
}

double reaction(const OutputState &state, const OutputForm &form,
                std::span<const OutputPart> parts) {
  double force = 0;
  for (const OutputPart &part : parts) {
    if (contact_of_part(part) >= 0) continue;
    const auto [row, given] = tested(state.scene, state.mu, state.cells, part, form.vector);
    double sum = given;
    for (const auto &[dof, entry] : row)
      sum += entry * state.u[dof];
    const Term &term = term_of(state.scene, part.term);
    force += sum * (term.theta ? coefficient_of(term, state.mu) : 1);
  }
  return force;
}

std::span<const OutputPart> parts_of(const OutputCells &cells, int output) {
  const auto found = std::ranges::equal_range(cells.parts, output, {}, &OutputPart::output);
  return {found.begin(), found.end()};
}

/// The integral of direction . u over a facet of the reference domain, and its size.
std::array<double, 2> facet_mean(const OutputState &state, const OutputPart &part,
                                 const Mean &mean) {
  const DisplacedCell cell = state.displaced(part.cell);
  const int dim = state.scene.dim;
  const double whole = facet_measure(dim, facet_cell(cell.cell, part.facet).reference).size;
  std::array<double, 2> sums{};
  const auto add = [&](const Barycentric &of_facet, double weight) {
    const Barycentric at = on_facet(dim, part.facet, of_facet);
    const Point x = point_at(cell.cell.reference, at, dim + 1);
    const double size = weight * whole * circumference(mean.axisymmetric, x);
    sums[0] += size * dot(mean.direction, displacement_at(state.scene, cell, at));
    sums[1] += size;
  };
  for (const auto &[s, weight] : edge_quadrature)
    if (dim == 2) add({1 - s, s, 0, 0}, weight);
  for (const auto &[at, weight] : radon_quadrature())
    if (dim == 3) add(at, weight);
  return sums;
}

double spring_force(const OutputState &state, const OutputForm &form,
                    std::span<const OutputPart> parts) {
  std::vector<std::array<double, 2>> means(form.means.size());
  for (const OutputPart &part : parts) {
    const auto [integral, size] = facet_mean(state, part, form.means[part.term]);
    means[part.term][0] += integral;
    means[part.term][1] += size;
  }
  double stretch = 0;
  for (const auto &[integral, size] : means)
    stretch += integral / size;
  return (form.stiffness ? form.stiffness(state.mu) * stretch : 0) +
         (form.preload ? form.preload(state.mu) : 0);
}

} // namespace

bool has_cells(const OutputForm &output) {
  return output.place != OutputForm::Place::contact;
}

bool is_extreme(const OutputForm &output) {
  return has_cells(output) && output.place != OutputForm::Place::point &&
         (output.kind == OutputForm::Kind::max || output.kind == OutputForm::Kind::min);
}

double output_value(const OutputForm &form, const OutputSums &sums) {
  switch (form.kind) {
  case OutputForm::Kind::integral:
  case OutputForm::Kind::measure: // of one, in the unit of the output
    return sums.integral;
  case OutputForm::Kind::mean:
    return sums.integral / sums.measure;
  case OutputForm::Kind::min:
    return sums.least;
  case OutputForm::Kind::max:
    return sums.largest;
  default:
    return std::numeric_limits<double>::quiet_NaN();
  }
}

std::optional<SeparatedReaction> separated_reaction(const Scene &scene, int output,
                                                    const OutputCells &cells) {
  const OutputForm &form = scene.outputs[output];
  if (form.kind != OutputForm::Kind::reaction) return std::nullopt;
  const std::span<const OutputPart> parts = parts_of(cells, output);
  SeparatedReaction result;
  for (const OutputPart &part : parts) {
    if (contact_of_part(part) >= 0) continue;
    if (!term_of(scene, part.term).theta) return std::nullopt;
    if (std::ranges::find(result.terms, part.term) == result.terms.end())
      result.terms.push_back(part.term);
  }
  result.rows = Matrix::Zero(std::ssize(result.terms), cells.points.rows() * scene.components);
  result.given = Vector::Zero(result.rows.rows());
  for (const OutputPart &part : parts) {
    if (contact_of_part(part) >= 0) continue;
    const Index q = std::ranges::find(result.terms, part.term) - result.terms.begin();
    const Tested of_part = tested(scene, {}, cells, part, form.vector);
    result.given[q] += of_part.given;
    for (const auto &[dof, entry] : of_part.row)
      result.rows(q, dof) += entry;
  }
  return result;
}

double reaction_value(const SeparatedReaction &reaction, const Scene &scene, const FullMu &mu,
                      const Vector &of_terms) {
  double force = 0;
  for (Index q = 0; q < of_terms.size(); ++q)
    force +=
        coefficient_of(term_of(scene, reaction.terms[q]), mu) * (of_terms[q] + reaction.given[q]);
  return image_count(scene.mirrors) * force;
}

std::vector<double> extremes_of_parts(const Scene &scene, int output, const FullMu &mu,
                                      const OutputCells &cells, const Vector &u) {
  const OutputState state{scene, mu, cells, u};
  const OutputForm &form = scene.outputs[output];
  std::vector<double> values;
  for (const OutputPart &part : parts_of(cells, output)) {
    OutputLines lines(form, mu, scene.mirrors);
    add_simplex(state, part, lines);
    values.push_back(output_value(form, lines.sums()));
  }
  return values;
}

double cell_output(const Scene &scene, int output, const FullMu &mu, const OutputCells &cells,
                   const Vector &u) {
  const OutputState state{scene, mu, cells, u};
  const OutputForm &form = scene.outputs[output];
  const std::span<const OutputPart> parts = parts_of(cells, output);
  if (form.kind == OutputForm::Kind::spring) return spring_force(state, form, parts);
  if (form.kind == OutputForm::Kind::reaction)
    return image_count(scene.mirrors) * reaction(state, form, parts);
  const MirrorPlanes none; // a point is itself alone
  OutputLines lines(form, mu, form.place == OutputForm::Place::point ? none : scene.mirrors);
  for (const OutputPart &part : parts) {
    if (form.place == OutputForm::Place::point)
      add_point(state, part, form.vector, lines);
    else
      add_simplex(state, part, lines);
  }
  return output_value(form, lines.sums());
}

} // namespace rbvi
