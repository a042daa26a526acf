#include "rbvi/mor/curve_quadrature.hpp"

#include "layer_interpolation.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/nonnegative_qp.hpp"
#include "rbvi/element/quadrature.hpp"
#include "rbvi/rom/nitsche_solver.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbvi {

namespace {

void describe_curve(const ContactLayer &layer, const ReducedModel &model, NitscheModel &nitsche) {
  const auto cells = static_cast<Index>(layer.cells.size());
  nitsche.vertices.resize(3 * cells, 2);
  for (Index k = 0; k < cells; ++k) {
    const CurveCell &cell = layer.cells[static_cast<std::size_t>(k)];
    for (Index v = 0; v < 3; ++v)
      for (Index c = 0; c < 2; ++c)
        nitsche.vertices(3 * k + v, c) =
            cell.cell.reference[static_cast<std::size_t>(v)][static_cast<std::size_t>(c)];
    nitsche.edges.push_back(cell.edge);
    nitsche.dofs.insert(nitsche.dofs.end(), cell.dofs.begin(), cell.dofs.end());
  }
  nitsche.trace = model.primal_basis(layer.natural, Eigen::all);
}

/// Abscissa of each Gauss point of the curve.
Vector abscissae(const std::vector<CurveCell> &cells) {
  Vector x(4 * static_cast<Index>(cells.size()));
  Index next = 0;
  for (const CurveCell &cell : cells) {
    const auto [i, j] = simplex_edges[static_cast<std::size_t>(cell.edge)];
    const double a = cell.cell.reference[static_cast<std::size_t>(i)][0],
                 b = cell.cell.reference[static_cast<std::size_t>(j)][0];
    for (const EdgePoint &point : edge_quadrature)
      x[next++] = (1 - point.s) * a + point.s * b;
  }
  return x;
}

/// The answers of the model with all points at the training parameters.
struct Answers {
  Matrix u; ///< n x P
  /// What each point adds to them to first order, at some of the parameters one below the other:
  /// tangent^-1 residual, relative to |u|. On a symmetric curve the points of one half stand for
  /// both.
  Matrix effects;
  std::vector<int> points; ///< number of each column
};

Answers answers_with_all(const ReducedModel &model, const Scene &scene,
                         const std::vector<CurveCell> &cells, const std::vector<Sample> &samples) {
  constexpr Index enough = 64; // parameters that the points are chosen by; all are checked
  const Vector x = abscissae(cells);
  const auto count = static_cast<Index>(samples.size()), n = Index{model.primal_size()};
  const Index step = (count + enough - 1) / enough;
  ReducedNitsche full(model, scene);
  Answers answers{Matrix(n, count), {}, {}};
  Matrix all(n * ((count + step - 1) / step), x.size());
  for (Index p = 0; p < count; ++p) {
    const Vector u =
        full.solve(expand(scene.parameters, samples[static_cast<std::size_t>(p)].mu)).u;
    answers.u.col(p) = u;
    if (p % step == 0)
      all.middleRows(n * (p / step), n) =
          Eigen::PartialPivLU<Matrix>(full.tangent()).solve(full.point_residuals()) /
          std::max(u.norm(), 1e-300);
  }
  for (Index q = 0; q < x.size(); ++q)
    if ((!scene.symmetric || x[q] < 0) && !all.col(q).isZero(0))
      answers.points.push_back(static_cast<int>(q));
  answers.effects = (scene.symmetric ? 2 : 1) * all(Eigen::all, answers.points);
  return answers;
}

/// Largest norm of the parts of a stacked vector.
double largest_part(const Vector &stacked, Index rows_each) {
  return std::sqrt(
      stacked.reshaped(rows_each, stacked.size() / rows_each).colwise().squaredNorm().maxCoeff());
}

/// The points with positive factors, and where queries start from there.
void set_points(const Answers &answers, const Vector &factors, const Matrix &pressures,
                NitscheModel &nitsche) {
  nitsche.points.clear();
  std::vector<double> positive;
  for (std::size_t k = 0; k < answers.points.size(); ++k) {
    const double factor = factors[static_cast<Index>(k)];
    if (!(factor > 0)) continue;
    nitsche.points.push_back(answers.points[k]);
    positive.push_back(factor);
  }
  nitsche.factors = Eigen::Map<const Vector>(positive.data(), static_cast<Index>(positive.size()));
  std::vector<int> rows = nitsche.points;
  const Index all = 4 * static_cast<Index>(nitsche.edges.size());
  for (std::size_t k = 0; k < nitsche.points.size() && pressures.rows() > all; ++k)
    rows.push_back(static_cast<int>(all) + nitsche.points[k]);
  nitsche.starts = pressures(rows, Eigen::all);
}

/// Largest relative distance of the answers of the model, with the points it has, to those with
/// all; infinite where it has none.
double error_of_points(const ReducedModel &model, const Scene &scene,
                       const std::vector<Sample> &samples, const Matrix &answers) {
  ReducedNitsche solver(model, scene);
  double error = 0;
  for (std::size_t p = 0; p < samples.size(); ++p) {
    const auto all = answers.col(static_cast<Index>(p));
    try {
      const Vector u = solver.solve(expand(scene.parameters, samples[p].mu)).u;
      error = std::max(error, (u - all).norm() / std::max(all.norm(), 1e-300));
    } catch (const Error &) {
      return std::numeric_limits<double>::infinity();
    }
  }
  return error;
}

/// Non-negative least squares, point by point; to first order first, and on until the answers
/// themselves are met. `pressures`: at all points, of the samples.
void choose_points(const Answers &answers, double tolerance, const Scene &scene,
                   const std::vector<Sample> &samples, const Matrix &pressures, ReducedModel &model,
                   CurveReport &report) {
  const Vector target = answers.effects.rowwise().sum();
  NonnegativeQp qp(answers.effects.rows(), {.max_iterations = 1});
  double first_order = tolerance;
  for (bool done = answers.effects.cols() == 0; !done; first_order *= 0.7) {
    for (double left = 2 * first_order; left > first_order && !done;) {
      done = qp.solve(answers.effects, target).converged;
      left = largest_part(qp.residual(), answers.u.rows());
    }
    set_points(answers, (scene.symmetric ? 2 : 1) * qp.x(), pressures, *model.nitsche);
    report.points.push_back(static_cast<int>(model.nitsche->points.size()));
    report.error.push_back(error_of_points(model, scene, samples, answers.u));
    done = done || report.error.back() <= tolerance;
  }
}

/// P_n and, with friction, P_tau of the samples at all points.
Matrix pressures_of(const Scene &scene, const ContactLayer &layer,
                    const std::vector<Sample> &samples) {
  const bool friction = scene.support->friction.law != FrictionLaw::none;
  const Index points = 4 * static_cast<Index>(layer.cells.size());
  Matrix result(friction ? 2 * points : points, static_cast<Index>(samples.size()));
  for (std::size_t p = 0; p < samples.size(); ++p) {
    const auto faces = nitsche_faces(scene, expand(scene.parameters, samples[p].mu), layer.cells);
    const Vector u = samples[p].u(layer.natural);
    result.col(static_cast<Index>(p)) = nitsche_pressures(faces, u).reshaped().head(result.rows());
  }
  return result;
}

} // namespace

CurveReport reduce_curve(Problem &problem, const std::vector<Sample> &samples, double u_left,
                         const CurveOptions &options, ReducedModel &model) {
  const Scene &scene = problem.scene();
  const ContactLayer layer =
      make_contact_layer(problem.mesh(), problem.dofs(), scene.support->boundary);
  CurveReport report;
  model.nitsche = NitscheModel{};
  NitscheModel &nitsche = *model.nitsche;
  describe_curve(layer, model, nitsche);
  nitsche.consistency = interpolate_consistency(scene, layer, samples, nitsche.trace);
  nitsche.starts_mu.resize(scene.parameters.size(), static_cast<Index>(samples.size()));
  for (std::size_t p = 0; p < samples.size(); ++p)
    std::copy(samples[p].mu.begin(), samples[p].mu.end(),
              nitsche.starts_mu.col(static_cast<Index>(p)).begin());
  nitsche.rule = CurveRule::full;
  nitsche.starts = pressures_of(scene, layer, samples);
  if (options.rule == CurveRule::full) report.points = {4 * static_cast<int>(layer.cells.size())};
  if (options.rule == CurveRule::empirical) {
    const Answers answers = answers_with_all(model, scene, layer.cells, samples);
    const Matrix pressures = nitsche.starts;
    nitsche.rule = CurveRule::empirical;
    choose_points(answers, options.tolerance > 0 ? options.tolerance : u_left / 2, scene, samples,
                  pressures, model, report);
    if (nitsche.points.empty())
      throw failure("there is no contact at any training mu, and nothing to integrate: widen the "
                    "parameter box");
  } else if (options.rule == CurveRule::interpolated) {
    report.states =
        interpolate_terms(problem, samples, {.tolerance = options.eim_tolerance}, nitsche);
    report.terms = {static_cast<int>(nitsche.contact_matrix.size()),
                    static_cast<int>(nitsche.contact_vector.size()),
                    static_cast<int>(nitsche.friction_matrix.size()),
                    static_cast<int>(nitsche.friction_vector.size())};
    nitsche.rule = CurveRule::interpolated;
    nitsche.starts.resize(0, 0); // from u = 0, as printed
    nitsche.starts_mu.resize(nitsche.starts_mu.rows(), 0);
  }
  return report;
}

} // namespace rbvi
