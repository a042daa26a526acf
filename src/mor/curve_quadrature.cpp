#include "rbvi/mor/curve_quadrature.hpp"

#include "layer_interpolation.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/nonnegative_qp.hpp"
#include "rbvi/element/quadrature.hpp"
#include "rbvi/rom/nitsche_solver.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

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

/// What each point adds to u at each training parameter, one below the other, relative to |u|.
struct PointEffects {
  Matrix columns;
  std::vector<int> points; ///< number of each column
  Index rows_each = 0;     ///< per training parameter
};

/// Of the answers of the model with all points. The effect of a residual r is tangent^-1 r. On a
/// symmetric curve the points of one half stand for both.
PointEffects point_effects(ReducedNitsche &full, const Scene &scene,
                           const std::vector<CurveCell> &cells, const std::vector<Sample> &samples,
                           Index n) {
  const Vector x = abscissae(cells);
  PointEffects effects;
  effects.rows_each = n;
  Matrix all(n * static_cast<Index>(samples.size()), x.size());
  for (std::size_t p = 0; p < samples.size(); ++p) {
    const NitscheAnswer answer = full.solve(expand(scene.parameters, samples[p].mu));
    const double size = std::max(answer.u.norm(), 1e-300);
    all.middleRows(n * static_cast<Index>(p), n) =
        Eigen::PartialPivLU<Matrix>(full.tangent()).solve(full.point_residuals()) / size;
  }
  const double share = scene.symmetric ? 2 : 1;
  for (Index q = 0; q < x.size(); ++q)
    if ((!scene.symmetric || x[q] < 0) && !all.col(q).isZero(0))
      effects.points.push_back(static_cast<int>(q));
  effects.columns = share * all(Eigen::all, effects.points);
  return effects;
}

/// Largest norm of the parts of a stacked vector.
double largest_part(const Vector &stacked, Index rows_each) {
  return std::sqrt(
      stacked.reshaped(rows_each, stacked.size() / rows_each).colwise().squaredNorm().maxCoeff());
}

/// Non-negative least squares, point by point, until every training answer is met.
void choose_points(const PointEffects &effects, double tolerance, double share,
                   NitscheModel &nitsche, CurveReport &report) {
  const Vector target = effects.columns.rowwise().sum();
  NonnegativeQp qp(effects.columns.rows(), {.max_iterations = 1});
  report.error.push_back(largest_part(target, effects.rows_each));
  while (report.error.back() > tolerance) {
    const NonnegativeQpReport step = qp.solve(effects.columns, target);
    report.error.push_back(largest_part(qp.residual(), effects.rows_each));
    if (step.converged) break;
  }
  for (std::size_t k = 0; k < effects.points.size(); ++k) {
    const double factor = qp.x().size() > 0 ? qp.x()[static_cast<Index>(k)] : 0;
    if (!(factor > 0)) continue;
    nitsche.points.push_back(effects.points[k]);
    nitsche.factors.conservativeResize(nitsche.factors.size() + 1);
    nitsche.factors[nitsche.factors.size() - 1] = share * factor;
  }
}

/// NitscheModel::starts, from the model's own answers.
void add_starts(const ReducedModel &model, const Scene &scene, const std::vector<Sample> &samples,
                NitscheModel &nitsche) {
  ReducedNitsche solver(model, scene);
  Matrix starts, where(scene.parameters.size(), static_cast<Index>(samples.size()));
  for (std::size_t p = 0; p < samples.size(); ++p) {
    (void)solver.solve(expand(scene.parameters, samples[p].mu));
    const Vector state = solver.state();
    const auto column = static_cast<Index>(p);
    if (starts.size() == 0) starts.resize(state.size(), where.cols());
    starts.col(column) = state;
    where.col(column) = Eigen::Map<const Vector>(samples[p].mu.data(), where.rows());
  }
  nitsche.starts = std::move(starts);
  nitsche.starts_mu = std::move(where);
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
  nitsche.rule = CurveRule::full;
  report.points = 4 * static_cast<int>(layer.cells.size());
  if (options.rule == CurveRule::empirical) {
    add_starts(model, scene, samples, nitsche); // the next sweep takes a few steps each
    ReducedNitsche full(model, scene);
    const PointEffects effects =
        point_effects(full, scene, layer.cells, samples, model.primal_size());
    choose_points(effects, options.tolerance > 0 ? options.tolerance : u_left / 3,
                  scene.symmetric ? 2 : 1, nitsche, report);
    if (nitsche.points.empty())
      throw failure("there is no contact at any training mu, and nothing to integrate: widen the "
                    "parameter box");
    report.points = static_cast<int>(nitsche.points.size());
    nitsche.rule = CurveRule::empirical;
    nitsche.starts.resize(0, 0);
  } else if (options.rule == CurveRule::interpolated) {
    report.states =
        interpolate_terms(problem, samples, {.tolerance = options.eim_tolerance}, nitsche);
    report.terms = {static_cast<int>(nitsche.contact_matrix.size()),
                    static_cast<int>(nitsche.contact_vector.size()),
                    static_cast<int>(nitsche.friction_matrix.size()),
                    static_cast<int>(nitsche.friction_vector.size())};
    nitsche.rule = CurveRule::interpolated;
  }
  if (options.rule != CurveRule::interpolated) add_starts(model, scene, samples, nitsche);
  return report;
}

} // namespace rbvi
