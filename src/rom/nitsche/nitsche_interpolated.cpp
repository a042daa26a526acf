#include "nitsche_interpolated.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/rom/model/packed.hpp"

#include <Eigen/LU>

#include <algorithm>

namespace rbvi {

namespace {

constexpr double accuracy = 1e-10; ///< change of u, relative (4.26)
constexpr double smallest_step = 1e-3;
constexpr int most_printed_steps = 20, most_halved_steps = 60;

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

void add_matrix(const LayerTerms &terms, const Vector &theta, Matrix &a) {
  if (terms.size() == 0) return;
  a += unpacked(terms.reduced * theta, a.rows());
}

} // namespace

ReducedNitsche::Interpolated::Interpolated(const ReducedModel &of, const NitscheLayer &whole)
    : model(*of.nitsche), trace(of.contact_trace), layer(whole), cells(touched(model, whole.cells)),
      contact_matrix(model.contact_matrix, cells), contact_vector(model.contact_vector, cells),
      friction_matrix(model.friction_matrix, cells), friction_vector(model.friction_vector, cells) {
}

ReducedNitsche::Interpolated::Terms
ReducedNitsche::Interpolated::terms(const std::vector<NitscheFace> &faces, const System &system,
                                    const Vector &u) const {
  const Vector on_layer = trace * u;
  const Matrix pressures = nitsche_pressures(faces, on_layer);
  const Vector contact = nitsche_residual(faces, on_layer, {});
  Vector sum = Vector::Zero(u.size());
  if (model.contact_vector.size() > 0)
    sum += model.contact_vector.reduced * contact_vector.of_vector(contact);
  if (model.friction_vector.size() > 0) {
    const Vector both = nitsche_residual(faces, on_layer, nitsche_bounds(faces, pressures));
    sum += model.friction_vector.reduced * friction_vector.of_vector(both - contact);
  }
  const Vector au = system.quadratic.a_gamma * u;
  return {au + sum - system.quadratic.f, au.norm() + sum.norm() + system.quadratic.f.norm()};
}

Matrix ReducedNitsche::Interpolated::tangent(const std::vector<NitscheFace> &faces,
                                             const System &system, const Vector &u) const {
  const Matrix pressures = nitsche_pressures(faces, trace * u);
  const std::vector<FaceBlock> contact = nitsche_tangent(faces, pressures, {});
  Matrix result = system.quadratic.a_gamma;
  add_matrix(model.contact_matrix,
             contact_matrix.of_blocks(selected(contact, contact_matrix.cells())), result);
  if (model.friction_matrix.size() > 0) {
    std::vector<FaceBlock> friction =
        nitsche_tangent(faces, pressures, nitsche_bounds(faces, pressures));
    for (std::size_t k = 0; k < friction.size(); ++k)
      friction[k] -= contact[k];
    add_matrix(model.friction_matrix,
               friction_matrix.of_blocks(selected(friction, friction_matrix.cells())), result);
  }
  return result;
}

/// But for bounds that move.
Matrix ReducedNitsche::Interpolated::derivative(const std::vector<NitscheFace> &faces,
                                                const System &system, const Vector &u) const {
  const Matrix pressures = nitsche_pressures(faces, trace * u);
  const std::vector<FaceBlock> contact = nitsche_tangent(faces, pressures, {});
  Matrix result = system.quadratic.a_gamma;
  const auto add = [&](const LayerTerms &terms, const SampledLayer &sampled,
                       const Matrix &on_layer) {
    Matrix theta(terms.size(), u.size());
    for (Index j = 0; j < u.size(); ++j)
      theta.col(j) = sampled.of_vector(on_layer.col(j));
    result += terms.reduced * theta;
  };
  const Matrix of_contact = times_trace(contact);
  if (model.contact_vector.size() > 0) add(model.contact_vector, contact_vector, of_contact);
  if (model.friction_vector.size() > 0) {
    const Vector bounds = nitsche_bounds(faces, pressures);
    add(model.friction_vector, friction_vector,
        times_trace(nitsche_tangent(faces, pressures, bounds)) - of_contact);
  }
  return result;
}

/// The blocks of `cells` times the trace: a row for each dof of the layer.
Matrix ReducedNitsche::Interpolated::times_trace(const std::vector<FaceBlock> &blocks) const {
  Matrix result = Matrix::Zero(trace.rows(), trace.cols());
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const std::array<int, 12> &dofs = cells[k].dofs;
    for (std::size_t i = 0; i < 12; ++i)
      for (std::size_t j = 0; j < 12; ++j)
        if (dofs[i] >= 0 && dofs[j] >= 0)
          result.row(dofs[i]) +=
              blocks[k](static_cast<Index>(i), static_cast<Index>(j)) * trace.row(dofs[j]);
  }
  return result;
}

int ReducedNitsche::Interpolated::solve(const FullMu &all_parameters, const Vector &near,
                                        System &system) {
  const std::vector<NitscheFace> faces = nitsche_faces(layer, all_parameters, cells);
  int steps = 0;
  for (const bool printed : {true, false}) {
    system.u = near;
    Terms here = terms(faces, system, system.u);
    const int most_steps = printed ? most_printed_steps : most_halved_steps;
    for (int step = 1; step <= most_steps; ++step) {
      ++steps;
      const Matrix slope =
          printed ? tangent(faces, system, system.u) : derivative(faces, system, system.u);
      const Vector d = -lu_solve(slope, here.residual);
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
                short_number(system.relative) +
                "; reduce again with -nitsche_quadrature empirical");
}

} // namespace rbvi
