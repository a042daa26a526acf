#include "rbvi/mor/output_candidates.hpp"

#include "rbvi/par/collective.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbvi {

namespace {

/// Whether samples tell where it is: parameters do not move it over the body.
bool is_known_by_samples(const Scene &scene, const OutputForm &form) {
  return is_extreme(form) && std::ranges::none_of(form.moved_by, [&](int parameter) {
           return std::ranges::find(scene.parameters.free, parameter) !=
                  scene.parameters.free.end();
         });
}

/// The displacement at the nodes of the cells.
Vector at_nodes(const Vector &u, const OutputCells &cells, Index components) {
  Vector result(std::ssize(cells.nodes) * components);
  for (std::size_t k = 0; k < cells.nodes.size(); ++k)
    result.segment(static_cast<Index>(k) * components, components) =
        u.segment(cells.nodes[k] * components, components);
  return result;
}

/// Marks parts from `first` on.
void mark(const std::vector<double> &values, bool largest, std::size_t first,
          std::vector<int> &keeps) {
  constexpr double part = 0.25; // bracket: as exact as all cells, at 4 times a query without it
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  for (std::size_t k = 0; k < values.size(); ++k)
    if (std::isfinite(values[k]) &&
        (largest ? high - values[k] : values[k] - low) <= part * (high - low))
      keeps[first + k] = 1;
}

/// All parts of an output that no sample has a value of: its condition may hold elsewhere.
void keep_unseen(const OutputCells &cells, std::vector<int> &keeps) {
  for (auto part = cells.parts.begin(); part != cells.parts.end();) {
    const auto next = std::find_if(part, cells.parts.end(),
                                   [&](const auto &of) { return of.output != part->output; });
    const auto first = keeps.begin() + (part - cells.parts.begin()), last = first + (next - part);
    if (std::ranges::count(first, last, 1) == 0) std::fill(first, last, 1);
    part = next;
  }
}

/// Marks the parts that may have an extreme value at the displacement `u` of the whole mesh.
void mark_at(const Scene &scene, const FullMu &mu, const OutputCells &cells, const Vector &u,
             std::vector<int> &keeps) {
  const Vector own = at_nodes(u, cells, scene.components);
  for (int output = 0; output < std::ssize(scene.outputs); ++output) {
    const OutputForm &form = scene.outputs[output];
    if (!is_known_by_samples(scene, form)) continue;
    const auto first =
        std::ranges::lower_bound(cells.parts, output, {}, &OutputCells::Part::output);
    mark(extremes_of_parts(scene, output, mu, cells, own), form.kind == OutputForm::Kind::max,
         static_cast<std::size_t>(first - cells.parts.begin()), keeps);
  }
}

} // namespace

OutputCells candidate_cells(MPI_Comm comm, const Scene &scene, const OutputCells &cells,
                            const std::vector<Sample> &samples) {
  std::vector<int> keeps;
  for (const OutputCells::Part &part : cells.parts)
    keeps.push_back(!is_known_by_samples(scene, scene.outputs[part.output]));
  if (std::ranges::all_of(keeps, [](int keep) { return keep != 0; })) return cells;
  int rank = 0, ranks = 1;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &ranks);
  for (std::size_t p = 0; p < samples.size(); ++p) {
    const Vector u = displacement(comm, samples[p]);
    collectively(comm, [&] {
      if (static_cast<int>(p % static_cast<std::size_t>(ranks)) != rank) return;
      mark_at(scene, expand(scene.parameters, samples[p].mu), cells, u, keeps);
    });
  }
  MPI_Allreduce(MPI_IN_PLACE, keeps.data(), static_cast<int>(keeps.size()), MPI_INT, MPI_MAX, comm);
  keep_unseen(cells, keeps);
  return some_of(cells, scene, {keeps.begin(), keeps.end()}).cells;
}

} // namespace rbvi
