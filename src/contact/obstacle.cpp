#include "rbvi/contact/obstacle.hpp"

#include "rbvi/contact/contact_area.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/element/cell_fields.hpp"
#include "rbvi/element/lagrange.hpp"
#include "rbvi/element/scalar_forms.hpp"

#include <algorithm>
#include <map>
#include <set>

namespace rbvi {

namespace {

class ObstacleInterface : public EntitySum {
public:
  ObstacleInterface(const Scene &scene, InterfaceMesh interface_mesh, Obstacle obstacle)
      : EntitySum(scene, std::move(interface_mesh), scene.dim), obstacle_(std::move(obstacle)),
        b_(hat_coupling("", -obstacle_.side, mesh_.degree, obstacle_.lumped)),
        g_(function_load("", -obstacle_.side, obstacle_.height, obstacle_.lumped)) {
    if (mesh_.components != 1 || mesh_.per_entity != nodes_per_cell(mesh_.dim, mesh_.degree))
      throw bad_input("scene " + scene.name + ": an obstacle is for scalar displacements");
    for (Index e = 0; e < mesh_.count(); ++e)
      simplices_.insert(simplices_.end(), mesh_.nodes_of(e), mesh_.nodes_of(e) + mesh_.dim + 1);
    set_dual(1 + *std::ranges::max_element(simplices_), 1, obstacle_.lumped, gram());
    if (!obstacle_.region.empty()) rim_ = rim();
    if (obstacle_.adhesion && obstacle_.lumped && dual_.nodes() < std::ssize(dual_of_vertex()))
      throw bad_input(
          "adhesion up to where a membrane is held is for exact quadrature: set lumped: "
          "no");
  }

  void integrate(const FullMu &mu, const Cell &cell, EntityValues &values) const override {
    b_.kernel(mu, cell, values.b.data());
    g_.kernel(mu, cell, values.g.data());
  }
  void weigh(const FullMu &mu, const Cell &cell, EntityValues &values) const override {
    static const Form hat_integrals = constant_load("", 1);
    hat_integrals.kernel(mu, cell, values.weights.data());
  }
  FrictionBound bound(const FullMu &mu) const override {
    return friction_bound({.adhesion = obstacle_.adhesion}, mu);
  }
  PointConstraint constraint_at(const FullMu &mu, const Point &, const Point &mapped,
                                const Point &) const override {
    return {{-obstacle_.side, 0, 0}, -obstacle_.side * obstacle_.height(mu, mapped)};
  }

  void outputs(const FullMu &mu, const ContactOperators &operators, const Vector &lambda,
               double least, Outputs &outputs) const override;
  Grid fields(const FullMu &mu, const Vector &u, const Vector &lambda, bool) override;

private:
  SparseMatrix gram() const;
  std::vector<Index> rim() const;
  Vector at_vertices(const Vector &normal) const;

  Obstacle obstacle_;
  Form b_, g_;
  std::vector<int> simplices_; ///< the vertices of each cell, which are the first nodes
  std::vector<Index> rim_;     ///< dual nodes on the rim of the region
};

SparseMatrix ObstacleInterface::gram() const {
  const Form product = l2_product("");
  const Index corners = mesh_.dim + 1;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> values(corners, corners);
  std::vector<Eigen::Triplet<double>> entries;
  for (Index e = 0; e < mesh_.count(); ++e) {
    product.kernel({}, reference_entity(e), values.data());
    for (Index i = 0; i < corners; ++i)
      for (Index j = 0; j < corners; ++j)
        entries.emplace_back(mesh_.nodes_of(e)[i], mesh_.nodes_of(e)[j], values(i, j));
  }
  const Index vertices = 1 + *std::ranges::max_element(simplices_);
  SparseMatrix result(vertices, vertices);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

/// Those of the facets of one cell alone, but for those that the body goes on beyond.
std::vector<Index> ObstacleInterface::rim() const {
  std::map<std::vector<int>, int> cells_of;
  const int corners = mesh_.dim + 1;
  for (auto cell = simplices_.begin(); cell != simplices_.end(); cell += corners)
    for (int left_out = 0; left_out < corners; ++left_out) {
      std::vector<int> facet(cell, cell + corners);
      facet.erase(facet.begin() + left_out);
      std::ranges::sort(facet);
      ++cells_of[facet];
    }
  const Vector images = image_counts(scene_.mirrors, mesh_.points);
  const auto is_inside = [&](int vertex) { return images[vertex] < image_count(scene_.mirrors); };
  std::set<Index> nodes;
  for (const auto &[facet, cells] : cells_of)
    for (const int vertex : facet)
      if (cells == 1 && !std::ranges::all_of(facet, is_inside))
        nodes.insert(dual_of_vertex()[vertex]);
  nodes.erase(-1);
  return {nodes.begin(), nodes.end()};
}

/// From dual functions; zero where there is none.
Vector ObstacleInterface::at_vertices(const Vector &normal) const {
  const std::vector<Index> &dual = dual_of_vertex();
  return Vector::NullaryExpr(std::ssize(dual), [&](Index v) {
    const Index i = dual[v];
    return i < 0 ? 0.0 : normal[i];
  });
}

void ObstacleInterface::outputs(const FullMu &, const ContactOperators &operators,
                                const Vector &lambda, double least, Outputs &outputs) const {
  const Vector images = image_counts(scene_.mirrors, dual_.points);
  pressure_outputs(images, operators.weights, lambda, least, outputs);
  if (!obstacle_.region.empty())
    outputs.ends_in_contact = (lambda(rim_).array() > least).select(images(rim_), 0).sum();
  if (!obstacle_.lumped) return;
  const Vector pressed = (lambda.array() > least).select(lambda, 0);
  outputs.contact_measure =
      contact_area(at_vertices(operators.weights), at_vertices(pressed), simplices_, mesh_.dim + 1);
}

Grid ObstacleInterface::fields(const FullMu &mu, const Vector &u, const Vector &lambda, bool) {
  Matrix points = mapped_points(scene_, mu, mesh_.points);
  straighten_edges(mesh_.entities, mesh_.dim, mesh_.degree, points);
  Matrix pressure = Matrix::Zero(mesh_.nodes(), 1);
  pressure.topRows(std::ssize(dual_of_vertex())) = at_vertices(lambda);
  straighten_edges(mesh_.entities, mesh_.dim, mesh_.degree, pressure);
  Vector gap(mesh_.nodes());
  for (Index i = 0; i < gap.size(); ++i) {
    const Point x{points(i, 0), points(i, 1), mesh_.dim == 3 ? points(i, 2) : 0};
    gap[i] = obstacle_.side * (u[i] - obstacle_.height(mu, x));
  }
  Grid grid{std::move(points),
            mesh_.entities,
            mesh_.per_entity,
            {{"pressure", pressure.col(0), "Pa"}},
            {},
            {}};
  add_gap(gap, std::vector<Point>(mesh_.points.size(), {0, 0, -obstacle_.side}), grid);
  grid.of_nodes.push_back({"u", u, "m"});
  return grid;
}

} // namespace

Term adhesive_load(const Obstacle &obstacle, const Scene &scene) {
  const auto onto = [adhesion = obstacle.adhesion, side = obstacle.side](const FullMu &mu,
                                                                         const Point &) {
    return Point{-side * adhesion(mu), 0, 0};
  };
  return mapped_term(body_load(obstacle.region, onto, 1, scene.degree));
}

ContactRecipe obstacle(Obstacle obstacle) {
  ContactRecipe recipe;
  recipe.entities = {InterfaceEntities::Kind::cells, {obstacle.region}};
  recipe.nodal = obstacle.lumped;
  recipe.push = obstacle.side;
  add_friction({.adhesion = obstacle.adhesion}, recipe);
  recipe.make = [obstacle](const Scene &scene, InterfaceMesh mesh) {
    return std::make_unique<ObstacleInterface>(scene, std::move(mesh), obstacle);
  };
  return recipe;
}

} // namespace rbvi
