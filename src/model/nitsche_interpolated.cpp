// Niakh (2022): (4.79), (4.80).
#include "nitsche_interpolated.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/model/packed.hpp"

#include <Eigen/LU>

#include <algorithm>

namespace rbvi {

namespace {

constexpr double accuracy = 1e-10; ///< change of u, relative (4.26)
constexpr double smallest_step = 1e-3;
constexpr int most_printed_steps = 20, most_halved_steps = 60, most_alone = 100;

/// Cells that any of the four operators is sampled on.
std::vector<CurveCell> touched(const NitscheModel &model, const std::vector<CurveCell> &all) {
  std::vector<int> numbers;
  for (const LayerTerms *terms : {&model.contact_matrix, &model.contact_vector,
                                  &model.friction_matrix, &model.friction_vector}) {
    const std::vector<int> more = SampledLayer(*terms, all).cells();
    numbers.insert(numbers.end(), more.begin(), more.end());
  }
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  return selected(all, numbers);
}

} // namespace

ReducedNitsche::Interpolated::Interpolated(const ReducedModel &of, const NitscheLayer &whole)
    : trace(of.contact.trace), layer(whole), cells(touched(*of.contact.nitsche, whole.cells)),
      parts{part(of.contact.nitsche->contact_matrix, of.contact.nitsche->contact_vector),
            part(of.contact.nitsche->friction_matrix, of.contact.nitsche->friction_vector)} {}

ReducedNitsche::Interpolated::Terms
ReducedNitsche::Interpolated::terms(const std::vector<NitscheFace> &faces, const System &system,
                                    const Vector &u) const {
  const Vector on_layer = trace * u;
  std::array<Vector, 2> on_dofs{nitsche_residual(faces, on_layer, {}), {}};
  const Vector bounds = nitsche_bounds(faces, nitsche_pressures(faces, on_layer));
  if (bounds.size() > 0) on_dofs[1] = nitsche_residual(faces, on_layer, bounds) - on_dofs[0];
  Vector sum = Vector::Zero(u.size());
  for (std::size_t k = 0; k < 2; ++k)
    if (parts[k].vector.size() > 0)
      sum += parts[k].vector.reduced * parts[k].at_vector.of_vector(on_dofs[k]);
  const Vector au = system.quadratic.a_gamma * u;
  return {au + sum - system.quadratic.f, au.norm() + sum.norm() + system.quadratic.f.norm()};
}

/// The interpolated matrix, as printed, or the derivative of the interpolated vectors, but for
/// bounds that move.
Matrix ReducedNitsche::Interpolated::slope(const std::vector<NitscheFace> &faces,
                                           const System &system, const Vector &u,
                                           bool printed) const {
  const Matrix pressures = nitsche_pressures(faces, trace * u);
  const Vector bounds = nitsche_bounds(faces, pressures);
  std::array<std::vector<FaceBlock>, 2> blocks{nitsche_tangent(faces, pressures, {}), {}};
  if (bounds.size() > 0) blocks[1] = nitsche_tangent(faces, pressures, bounds);
  const bool joint = printed && parts[0].matrix.size() == 0;
  for (std::size_t k = 0; k < blocks[1].size() && !joint; ++k)
    blocks[1][k] -= blocks[0][k];
  Matrix result = system.quadratic.a_gamma;
  for (std::size_t k = 0; k < 2; ++k) {
    const Part &one = parts[k];
    if (printed && one.matrix.size() > 0) {
      const std::vector<FaceBlock> sampled = selected(blocks[k], one.at_matrix.cells());
      result += unpacked(one.matrix.reduced * one.at_matrix.of_blocks(sampled), u.size());
    } else if (!printed && one.vector.size() > 0) {
      const Matrix on_dofs = times_trace(blocks[k]);
      Matrix theta(one.vector.size(), u.size());
      for (Index j = 0; j < u.size(); ++j)
        theta.col(j) = one.at_vector.of_vector(on_dofs.col(j));
      result += one.vector.reduced * theta;
    }
  }
  return result;
}

/// The blocks of `cells` times the trace: a row for each dof of the layer.
Matrix ReducedNitsche::Interpolated::times_trace(const std::vector<FaceBlock> &blocks) const {
  Matrix result = Matrix::Zero(trace.rows(), trace.cols());
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const Matrix rows = blocks[k] * basis_on(cells[k], trace);
    for (Index i = 0; i < 12; ++i)
      if (cells[k].dofs[i] >= 0) result.row(cells[k].dofs[i]) += rows.row(i);
  }
  return result;
}

int ReducedNitsche::Interpolated::solve(const FullMu &all_parameters, const Vector &near,
                                        System &system) {
  const std::vector<NitscheFace> faces = nitsche_faces(layer, all_parameters, cells);
  int steps = 0;
  const bool alone = near.size() == 0;
  for (const bool printed : {true, false}) {
    if (alone && !printed) break;
    system.u = alone ? Vector(Vector::Zero(trace.cols())) : near;
    Terms here = terms(faces, system, system.u);
    const int most_steps = alone ? most_alone : printed ? most_printed_steps : most_halved_steps;
    for (int step = 1; step <= most_steps; ++step) {
      ++steps;
      const Vector d = -lu_solve(slope(faces, system, system.u, printed), here.residual);
      if (!d.allFinite()) break;
      double t = 1;
      Terms next = terms(faces, system, system.u + d);
      while (!printed && !(next.residual.norm() < here.residual.norm()) && t > smallest_step) {
        t /= 2;
        next = terms(faces, system, system.u + t * d);
      }
      system.u += t * d;
      here = std::move(next);
      system.relative = here.scale == 0 ? 0 : here.residual.norm() / here.scale;
      if (d.norm() <= accuracy * system.u.norm()) return steps;
    }
  }
  throw failure("the interpolated problem did not converge: its residual is " +
                short_number(system.relative) + "; " +
                (alone ? "use the method exact, or " : "") +
                "reduce again with -nitsche_quadrature empirical");
}

} // namespace rbvi
