// Cells of the mesh that outputs of a scene apart from contact are taken from, whole meshes apart.
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/core/scene.hpp"

#include <optional>
#include <vector>

namespace rbvi {

struct OutputCells {
  /// What of a cell belongs to an output.
  struct Part {
    int output = 0; ///< number in Scene::outputs
    int cell = 0;
    int facet = -1; ///< -1: the whole cell
    int term = 0;   ///< of a reaction: in a, then in f, or ~contact; of a spring: its mean
    int held = 0;   ///< of a reaction: a bit for each node of the cell that it is the force on
  };
  Matrix points;               ///< nodes x dim, reference coordinates
  std::vector<int> nodes;      ///< their numbers in the whole mesh
  std::vector<int> cells;      ///< node numbers of each, nodes_per_cell of them
  std::vector<int> materials;  ///< of each cell (Scene::materials); empty: the first
  std::vector<int> imposed_by; ///< Cell::imposed_by of each dof; empty: nothing is imposed
  std::vector<Part> parts;     ///< by output
};

/// The contact that a part of a reaction has the forces of; -1: it is of a or f.
inline int contact_of_part(const OutputCells::Part &part) {
  return part.term < 0 ? ~part.term : -1;
}

/// Whether an output needs cells.
bool has_cells(const OutputForm &output);

/// Some of the parts, with their cells and nodes alone.
struct SomeOutputCells {
  OutputCells cells;
  std::vector<Index> nodes; ///< which of all nodes its own are, rising
};
/// `keeps`: of each part.
SomeOutputCells some_of(const OutputCells &cells, const Scene &scene,
                        const std::vector<bool> &keeps);

/// Whether an output is the largest or the smallest value over cells.
bool is_extreme(const OutputForm &output);

/// Of output number `output`, which is_extreme, the value on each of its parts; not finite where
/// there is none. As cell_output.
std::vector<double> extremes_of_parts(const Scene &scene, int output, const FullMu &mu,
                                      const OutputCells &cells, const Vector &u);

/// Value of output number `output` of these cells. `u`: at the nodes, node * components + c, with
/// imposed values and without the motion. Not finite where there is nothing, or a field is not
/// there.
double cell_output(const Scene &scene, int output, const FullMu &mu, const OutputCells &cells,
                   const Vector &u);

/// A reaction whose terms depend on mu by factors alone:
/// sum over q of theta_q(mu) (rows.row(q) . u + given[q]).
struct SeparatedReaction {
  std::vector<int> terms; ///< numbers of terms q in a, then in f
  Matrix rows;            ///< terms x (nodes * components), of u as in cell_output
  Vector given;
};

/// Of output number `output`; empty where it is no reaction, or a term is mapped.
std::optional<SeparatedReaction> separated_reaction(const Scene &scene, int output,
                                                    const OutputCells &cells);

/// `of_terms`: rows u.
double reaction_value(const SeparatedReaction &reaction, const Scene &scene, const FullMu &mu,
                      const Vector &of_terms);

} // namespace rbvi
