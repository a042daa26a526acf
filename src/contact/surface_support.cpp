#include "surface_support.hpp"

#include "rbvi/contact/entity_sum.hpp"
#include "rbvi/contact/support_outputs.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/cell_fields.hpp"
#include "rbvi/element/facets.hpp"
#include "rbvi/element/quadrature.hpp"
#include "surface_frames.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace rbvi {

namespace {

constexpr std::size_t corners = 3;

/// A quadrature point of every triangle; the weights sum to 1.
struct SurfacePlace {
  double weight;
  std::array<double, 4> eta; ///< of the vertices: multipliers are linear
  std::array<double, 6> phi; ///< of the displacements: vertices, middles
};

std::vector<SurfacePlace> surface_places(int degree, bool lumped) {
  std::vector<SurfacePlace> places;
  if (lumped)
    for (std::size_t v = 0; v < corners; ++v) {
      SurfacePlace &place = places.emplace_back(SurfacePlace{1.0 / corners, {}, {}});
      place.eta[v] = place.phi[v] = 1;
    }
  else
    for (const QuadraturePoint &at : radon_quadrature()) {
      SurfacePlace &place = places.emplace_back(SurfacePlace{at.weight, at.barycentric, {}});
      lagrange_values(2, degree, place.eta, place.phi);
    }
  return places;
}

class SurfaceSupport : public EntitySum {
public:
  SurfaceSupport(const Scene &scene, InterfaceMesh mesh, const RigidContact &rigid);

  void integrate(const FullMu &mu, const Cell &facet, EntityValues &values) const override;
  void weigh(const FullMu &, const Cell &facet, EntityValues &values) const override {
    values.weights.setConstant(facet_measure(3, facet.mapped).size / corners);
  }
  FrictionBound bound(const FullMu &mu) const override { return friction_bound(friction_, mu); }
  std::vector<int> free_tangents() const override;
  PointConstraint constraint_at(const FullMu &mu, const Point &x, const Point &,
                                const Point &displacement) const override {
    const FacedPoint at = facing_.at(mu, place(scene_, facing_, mu, x), displacement);
    return {at.normal, at.gap};
  }
  PointForces point_forces(const FullMu &mu, const ContactState &,
                           const Vector &lambda) const override;
  void outputs(const FullMu &mu, const ContactOperators &operators, const Vector &lambda,
               double least, Outputs &outputs) const override;
  double gap_error(const FullMu &mu, const Vector &u, const Vector &lambda) const override {
    return rbvi::gap_error(*this, scene_, facing_, mu, u, lambda);
  }
  Grid fields(const FullMu &mu, const Vector &u, const Vector &lambda, bool whole) override;

private:
  struct Faced {
    double measure;
    Point x; ///< mapped
    FacedPoint at;
    Point motion;
  };
  Faced faced_at(const FullMu &mu, const Cell &facet, const SurfacePlace &at) const;
  Cell mapped_facet(const FullMu &mu, Index facet) const;
  using Frames = std::array<Frame, corners>;
  Frame frame_at(const FullMu &mu, Index vertex) const;
  Frames frames_at(const FullMu &mu, const Cell &facet) const;
  static Point shear_at(const Frames &frames, const SurfacePlace &at, const Point &n,
                        std::span<const int> rows, const Vector &lambda);
  double tangential_force(const FullMu &mu, const Vector &lambda) const;
  Vector shear_sizes(const Vector &lambda) const;
  double direction_count(const FullMu &mu, const Vector &lambda) const;
  void check_body_normal() const;

  Facing facing_;
  Friction friction_;
  std::vector<SurfacePlace> places_;
  Index vertices_;
  std::vector<Frame> frames_; ///< of the vertices, by the normals of the reference mesh
  std::vector<Index> owner_;  ///< of each the vertex whose multipliers its function has
  std::map<Point, int> at_;   ///< the vertices by their reference coordinates
  Vector images_;             ///< of the dual nodes
};

SurfaceSupport::SurfaceSupport(const Scene &scene, InterfaceMesh interface_mesh,
                               const RigidContact &rigid)
    : EntitySum(scene, std::move(interface_mesh), 2), facing_(rigid.facing),
      friction_(rigid.friction), places_(surface_places(mesh_.degree, rigid.lumped)) {
  if (facing_.follows_state)
    throw bad_input("contact in space is that of small kinematics: leave out kinematics: large");
  if (mesh_.components != 3 || mesh_.per_entity != nodes_per_cell(2, mesh_.degree) ||
      mesh_.count() == 0)
    throw bad_input("scene " + scene.name + ": contact of a solid is along triangles");
  vertices_ = 1 + *std::ranges::max_element(mesh_.entities, {}, [&](const int &node) {
                const auto at = &node - mesh_.entities.data();
                return at % mesh_.per_entity < static_cast<std::ptrdiff_t>(corners) ? node : -1;
              });
  frames_ = reference_frames(mesh_, vertices_);
  check_body_normal();
  const bool friction = friction_.law != FrictionLaw::none;
  set_dual(vertices_, friction ? 3 : 1, rigid.lumped, surface_gram(mesh_, frames_, friction));
  for (Index v = 0; v < vertices_; ++v) {
    at_.emplace(mesh_.points[v], static_cast<int>(v));
    owner_.push_back(dual_of_vertex()[v] < 0 ? v : dual_.vertices[dual_of_vertex()[v]]);
  }
  images_ = image_counts(scene.mirrors, dual_.points);
}

std::vector<int> SurfaceSupport::free_tangents() const {
  std::vector<int> free;
  for (const Index vertex : dual_.vertices)
    free.push_back(frames_[vertex].free);
  return free;
}

/// Throws bad_input where the normal of the body is not that of its triangles.
void SurfaceSupport::check_body_normal() const {
  constexpr double scatter = 0.05; // of vertices near each other
  if (!facing_.body_normal) return;
  FullMu mu;
  for (const Parameter &parameter : scene_.parameters.all)
    mu.push_back(parameter.value);
  for (Index e = 0; e < mesh_.count(); ++e) {
    const Cell facet = mapped_facet(mu, e);
    const Point x = (facet.reference[0] + facet.reference[1] + facet.reference[2]) / 3,
                n = facing_.body_normal(mu, x), of_facet = facet_measure(3, facet.mapped).normal;
    double turning = 0;
    for (std::size_t a = 0; a < corners; ++a)
      turning = std::max(turning, norm(facing_.body_normal(mu, facet.reference[a]) - n));
    if (!(norm(n - of_facet) <= turning + scatter))
      throw bad_input("scene " + scene_.name + ": the normal of the contact boundary at " +
                      place_text(x) + " is " + place_text(n) + ", and that of its triangle " +
                      place_text(of_facet) +
                      ": does the boundary have another sphere or cylinder, or is it that of a "
                      "hole?");
  }
}

Cell SurfaceSupport::mapped_facet(const FullMu &mu, Index e) const {
  Cell facet = reference_entity(e);
  for (std::size_t i = 0; i < corners; ++i)
    facet.mapped[i] = scene_.map(mu, facet.reference[i]);
  return facet;
}

SurfaceSupport::Faced SurfaceSupport::faced_at(const FullMu &mu, const Cell &facet,
                                               const SurfacePlace &at) const {
  const PlacedPoint point = place(scene_, facing_, mu, point_at(facet.reference, at.eta, corners));
  return {at.weight * facet_measure(3, facet.mapped).size, point_at(facet.mapped, at.eta, corners),
          facing_.at(mu, point, {}), point.motion};
}

/// The frame of the multipliers of a vertex at mu, by the normal of contact there.
Frame SurfaceSupport::frame_at(const FullMu &mu, Index vertex) const {
  const Frame &frame = frames_[owner_[vertex]];
  const Point &x = mesh_.points[owner_[vertex]],
              n = facing_.normal ? facing_.normal(mu, curve_point(facing_, x))
                                 : facing_.at(mu, place(scene_, facing_, mu, x), {}).normal;
  return {n, {carried(frame, 0, n), carried(frame, 1, n)}, frame.free};
}

/// Vertices of sampled triangles are known by where they are. Not used without friction.
SurfaceSupport::Frames SurfaceSupport::frames_at(const FullMu &mu, const Cell &facet) const {
  Frames frames{};
  for (std::size_t a = 0; a < corners && dual_.components == 3; ++a)
    frames[a] = frame_at(mu, at_.at(facet.reference[a]));
  return frames;
}

void SurfaceSupport::integrate(const FullMu &mu, const Cell &facet, EntityValues &values) const {
  const bool friction =
      values.b.rows() > static_cast<Index>(corners) && (values.b.cols() > 0 || scene_.motion);
  const Frames frames = friction ? frames_at(mu, facet) : Frames{};
  values.b.setZero();
  values.g.setZero();
  for (const SurfacePlace &at : places_) {
    const auto [weight, x, here, motion] = faced_at(mu, facet, at);
    const auto add = [&](Index row, double eta, const Point &direction, double of_motion) {
      for (Index k = 0; k < values.b.cols(); ++k)
        values.b(row, k) += eta * at.phi[k / 3] * direction[k % 3];
      values.g[row] += eta * of_motion;
    };
    for (std::size_t a = 0; a < corners; ++a) {
      const double eta = weight * at.eta[a];
      if (eta == 0) continue;
      const auto row = static_cast<Index>(a);
      add(row, eta, here.normal, here.gap);
      for (int k = 0; k < frames[a].free && friction; ++k) {
        const Point t = carried(frames[a], k, here.normal);
        add(static_cast<Index>(corners + 2 * a) + k, eta, t, -dot(t, motion));
      }
    }
  }
}

/// The tangential traction, where the normal is n.
Point SurfaceSupport::shear_at(const Frames &frames, const SurfacePlace &at, const Point &n,
                               std::span<const int> rows, const Vector &lambda) {
  Point shear{};
  for (std::size_t i = corners; i < rows.size(); ++i)
    if (const std::size_t a = (i - corners) / 2; rows[i] >= 0 && lambda[rows[i]] != 0)
      shear = shear + at.eta[a] * lambda[rows[i]] * carried(frames[a], (i - corners) % 2, n);
  return shear;
}

/// Of the triangles with multipliers that are not zero.
PointForces SurfaceSupport::point_forces(const FullMu &mu, const ContactState &,
                                         const Vector &lambda) const {
  PointForces forces;
  for (Index e = 0; e < mesh_.count(); ++e) {
    const std::span<const int> rows = rows_of(e);
    if (std::ranges::none_of(rows, [&](Index row) { return row >= 0 && lambda[row] != 0; }))
      continue;
    const Cell facet = mapped_facet(mu, e);
    const Frames frames = frames_at(mu, facet);
    for (const SurfacePlace &at : places_) {
      const auto [weight, x, here, motion] = faced_at(mu, facet, at);
      double pressure = 0;
      for (std::size_t a = 0; a < corners; ++a)
        if (rows[a] >= 0) pressure += at.eta[a] * lambda[rows[a]];
      if (pressure > 0)
        check_pressed_side(dot(here.normal, facet_measure(3, facet.mapped).normal),
                           point_at(facet.reference, at.eta, corners));
      forces.push_back(
          {0, x,
           -weight * (pressure * here.normal + shear_at(frames, at, here.normal, rows, lambda))});
    }
  }
  return forces;
}

double SurfaceSupport::tangential_force(const FullMu &mu, const Vector &lambda) const {
  double sum = 0;
  for (Index e = 0; e < mesh_.count(); ++e) {
    const std::span<const int> rows = rows_of(e);
    if (std::ranges::none_of(rows.subspan(corners),
                             [&](Index row) { return row >= 0 && lambda[row] != 0; }))
      continue;
    const Cell facet = mapped_facet(mu, e);
    const Frames frames = frames_at(mu, facet);
    for (const SurfacePlace &at : places_) {
      const Faced faced = faced_at(mu, facet, at);
      sum += faced.measure * norm(shear_at(frames, at, faced.at.normal, rows, lambda));
    }
  }
  return sum;
}

/// Per dual node.
Vector SurfaceSupport::shear_sizes(const Vector &lambda) const {
  return lambda.tail(2 * dual_.nodes()).reshaped(2, dual_.nodes()).colwise().norm();
}

/// 1 where the tangential tractions of all nodes of the whole body in contact have a part along
/// their sum, else 2.
double SurfaceSupport::direction_count(const FullMu &mu, const Vector &lambda) const {
  std::vector<Point> tractions;
  Point sum{};
  for (Index i = 0; i < dual_.nodes(); ++i) {
    if (!(lambda[i] > 0)) continue;
    Point &traction = tractions.emplace_back(Point{});
    const Frame frame = frame_at(mu, dual_.vertices[i]);
    for (std::size_t k = 0; k < 2; ++k)
      traction =
          traction + lambda[dual_.nodes() + 2 * i + static_cast<Index>(k)] * frame.tangents[k];
    sum = sum + traction;
  }
  for (const MirrorPlane &plane : mirrors())
    sum[static_cast<std::size_t>(plane.component)] = 0;
  constexpr double round_off = 1e-9; // of the largest: where a traction is zero by symmetry
  double largest = 0;
  for (const Point &of : tractions)
    largest = std::max(largest, norm(of));
  return std::ranges::all_of(
             tractions,
             [&](const Point &of) { return dot(of, sum) > 0 || norm(of) <= round_off * largest; })
             ? 1
             : 2;
}

void SurfaceSupport::outputs(const FullMu &mu, const ContactOperators &operators,
                             const Vector &lambda, double, Outputs &outputs) const {
  const Vector pressure = lambda.head(dual_.nodes());
  pressure_outputs(images_, operators.weights, pressure, 0, outputs);
  if (dual_.components == 3) {
    Vector sizes(2 * dual_.nodes());
    sizes << pressure, shear_sizes(lambda);
    friction_outputs(images_, tangential_force(mu, lambda), operators.weights, sizes, bound(mu),
                     outputs);
    outputs.slip_directions = direction_count(mu, lambda);
    outputs.stick_half_width.reset();
  }
  Point force{};
  for (const PointForce &at : point_forces(mu, operators.state, lambda))
    force = force + at.force;
  outputs.force_x = force[0];
  outputs.force_y = force[1];
  outputs.force_z = force[2];
  if (mesh_.closed_ends.empty()) return;
  outputs.ends_in_contact = 0;
  for (Index i = 0; i < dual_.nodes(); ++i)
    if (mesh_.closed_ends[dual_.vertices[i]] == 0 && pressure[i] > 0)
      *outputs.ends_in_contact += images_[i];
}

Grid SurfaceSupport::fields(const FullMu &mu, const Vector &u, const Vector &lambda, bool) {
  const bool friction = dual_.components == 3;
  Matrix points = mapped_points(scene_, mu, mesh_.points);
  Matrix stresses = Matrix::Zero(mesh_.nodes(), 4); // pressure, tangential traction
  std::vector<Point> normals;
  Vector gap(mesh_.nodes()), slip(3 * mesh_.nodes());
  const Vector moved = moved_nodes(scene_, mu, mesh_, u);
  for (Index i = 0; i < mesh_.nodes(); ++i) {
    const PointConstraint at = ContactInterface::constraint_at(mu, mesh_.points[i], {});
    const Point w{moved[3 * i], moved[3 * i + 1], moved[3 * i + 2]};
    gap[i] = at.gap - dot(at.direction, {u[3 * i], u[3 * i + 1], u[3 * i + 2]});
    const Point along = w - dot(w, at.direction) * at.direction;
    slip.segment<3>(3 * i) << along[0], along[1], along[2];
    normals.push_back(at.direction);
    const Index dual = i < vertices_ ? dual_of_vertex()[i] : -1;
    if (dual < 0) continue;
    stresses(i, 0) = lambda[dual];
    for (std::size_t k = 0; k < 2 && friction; ++k) {
      const Point t = carried(frame_at(mu, i), k, at.direction);
      const double part = lambda[dual_.nodes() + 2 * dual + static_cast<Index>(k)];
      stresses.row(i).tail<3>() += part * Eigen::RowVector3d(t[0], t[1], t[2]);
    }
  }
  straighten_edges(mesh_.entities, 2, mesh_.degree, points);
  straighten_edges(mesh_.entities, 2, mesh_.degree, stresses);
  Grid grid{std::move(points), mesh_.entities, mesh_.per_entity, {{"u", moved, "m"}}, {}, {}};
  add_gap(gap, normals, grid);
  grid.of_nodes.push_back({"slip", slip, "m"});
  grid.of_nodes.push_back({"pressure", stresses.col(0), "Pa"});
  if (friction)
    grid.of_nodes.push_back(
        {"tangential_stress", Matrix(stresses.rightCols(3).transpose()).reshaped(), "Pa"});
  return grid;
}

} // namespace

std::unique_ptr<ContactInterface> surface_support(const Scene &scene, InterfaceMesh mesh,
                                                  const RigidContact &rigid) {
  return std::make_unique<SurfaceSupport>(scene, std::move(mesh), rigid);
}

} // namespace rbvi
