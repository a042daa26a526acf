// Nitsche's method on operators of the curve that are interpolated over (mu, Newton step). There is
// no energy: (4.79) and (4.80) as printed, from neighbouring samples; where it does not converge,
// the derivative of its vectors, with halved steps. Niakh (2022): (4.26), (4.79), (4.80).
#include "../nitsche_system.hpp"
#include "queries.hpp"
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

/// The method on the operators of one model.
class PrintedNewton : public InterpolatedCurve {
public:
  /// Both must outlive it.
  PrintedNewton(const ReducedModel &of, const NitscheLayer &whole);
  InterpolatedAnswer solve(const FullMu &all_parameters, const Vector &near, const Matrix &a_gamma,
                           const Vector &f) const override;

private:
  /// The interpolated terms of contact or of friction.
  struct Part {
    const LayerTerms &matrix, &vector;
    SampledLayer at_matrix, at_vector;
  };
  /// The interpolated problem at one mu.
  struct AtMu {
    std::vector<NitscheFace> faces;
    const Matrix &a_gamma; ///< n x n
    const Vector &f;       ///< n
  };
  /// The interpolated terms at one iterate.
  struct Terms {
    Vector residual;
    double scale;
    double relative() const { return scale == 0 ? 0 : residual.norm() / scale; }
  };
  Terms terms(const AtMu &at, const Vector &u) const;
  Part part(const LayerTerms &matrix, const LayerTerms &vector) const {
    return {matrix, vector, {matrix, cells_}, {vector, cells_}};
  }
  /// The matrix of a step: that of (4.79), which is interpolated by itself, or the derivative of
  /// the interpolated vectors, but for bounds that move.
  Matrix slope(const AtMu &at, const Vector &u, bool own_matrix) const;
  Matrix times_trace(const std::vector<FaceBlock> &blocks) const;

  const Matrix &trace_; ///< contact dofs x n: the primal basis
  const NitscheLayer &layer_;
  const std::vector<CurveCell> cells_; ///< that some sampled entry touches
  const std::array<Part, 2> parts_;    ///< of contact, of friction
};

PrintedNewton::PrintedNewton(const ReducedModel &of, const NitscheLayer &whole)
    : trace_(of.contact.trace), layer_(whole), cells_(touched(*of.contact.nitsche, whole.cells)),
      parts_{part(of.contact.nitsche->contact_matrix, of.contact.nitsche->contact_vector),
             part(of.contact.nitsche->friction_matrix, of.contact.nitsche->friction_vector)} {}

PrintedNewton::Terms PrintedNewton::terms(const AtMu &at, const Vector &u) const {
  const Vector on_layer = trace_ * u;
  std::array<Vector, 2> on_dofs{nitsche_residual(at.faces, on_layer, {}), {}};
  const Vector bounds = nitsche_bounds(at.faces, nitsche_pressures(at.faces, on_layer));
  if (bounds.size() > 0) on_dofs[1] = nitsche_residual(at.faces, on_layer, bounds) - on_dofs[0];
  Vector sum = Vector::Zero(u.size());
  for (std::size_t k = 0; k < 2; ++k)
    if (parts_[k].vector.size() > 0)
      sum += parts_[k].vector.reduced * parts_[k].at_vector.of_vector(on_dofs[k]);
  const Vector au = at.a_gamma * u;
  return {au + sum - at.f, au.norm() + sum.norm() + at.f.norm()};
}

Matrix PrintedNewton::slope(const AtMu &at, const Vector &u, bool own_matrix) const {
  const Matrix pressures = nitsche_pressures(at.faces, trace_ * u);
  const Vector bounds = nitsche_bounds(at.faces, pressures);
  std::array<std::vector<FaceBlock>, 2> blocks{nitsche_tangent(at.faces, pressures, {}), {}};
  if (bounds.size() > 0) blocks[1] = nitsche_tangent(at.faces, pressures, bounds);
  const bool joint = own_matrix && parts_[0].matrix.size() == 0;
  for (std::size_t k = 0; k < blocks[1].size() && !joint; ++k)
    blocks[1][k] -= blocks[0][k];
  Matrix result = at.a_gamma;
  for (std::size_t k = 0; k < 2; ++k) {
    const Part &one = parts_[k];
    if (own_matrix && one.matrix.size() > 0) {
      const std::vector<FaceBlock> sampled = selected(blocks[k], one.at_matrix.cells());
      result += unpacked(one.matrix.reduced * one.at_matrix.of_blocks(sampled), u.size());
    } else if (!own_matrix && one.vector.size() > 0) {
      const Matrix on_dofs = times_trace(blocks[k]);
      Matrix theta(one.vector.size(), u.size());
      for (Index j = 0; j < u.size(); ++j)
        theta.col(j) = one.at_vector.of_vector(on_dofs.col(j));
      result += one.vector.reduced * theta;
    }
  }
  return result;
}

/// The blocks of the cells times the trace: a row for each dof of the layer.
Matrix PrintedNewton::times_trace(const std::vector<FaceBlock> &blocks) const {
  Matrix result = Matrix::Zero(trace_.rows(), trace_.cols());
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const Matrix rows = blocks[k] * basis_on(cells_[k], trace_);
    for (Index i = 0; i < 12; ++i)
      if (cells_[k].dofs[i] >= 0) result.row(cells_[k].dofs[i]) += rows.row(i);
  }
  return result;
}

InterpolatedAnswer PrintedNewton::solve(const FullMu &all_parameters, const Vector &near,
                                        const Matrix &a_gamma, const Vector &f) const {
  const AtMu at{nitsche_faces(layer_, all_parameters, cells_), a_gamma, f};
  InterpolatedAnswer found{{}, 0, 0};
  const bool alone = near.size() == 0;
  for (const bool own_matrix : {true, false}) {
    if (alone && !own_matrix) break;
    found.u = alone ? Vector(Vector::Zero(trace_.cols())) : near;
    Terms here = terms(at, found.u);
    const int most_steps = alone ? most_alone : own_matrix ? most_printed_steps : most_halved_steps;
    for (int step = 1; step <= most_steps; ++step) {
      ++found.iterations;
      const Vector d = -lu_solve(slope(at, found.u, own_matrix), here.residual);
      if (!d.allFinite()) break;
      double t = 1;
      Terms next = terms(at, found.u + d);
      while (!own_matrix && !(next.residual.norm() < here.residual.norm()) && t > smallest_step) {
        t /= 2;
        next = terms(at, found.u + t * d);
      }
      found.u += t * d;
      here = std::move(next);
      found.residual = here.relative();
      if (d.norm() <= accuracy * found.u.norm()) return found;
    }
  }
  throw failure("the interpolated problem did not converge: its residual is " +
                short_number(found.residual) + "; " + (alone ? "use the method exact, or " : "") +
                "reduce again with -nitsche_quadrature empirical");
}

} // namespace

std::unique_ptr<InterpolatedCurve> interpolated_curve(const ReducedModel &model,
                                                      const NitscheLayer &layer) {
  return std::make_unique<PrintedNewton>(model, layer);
}

} // namespace rbvi
