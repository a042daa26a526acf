// Reduced models of any size on the forms of membrane_obstacle, and of a toy scene whose forms are
// given numbers, for tests that compute the answer another way.
#pragma once

#include "rbvi/contact/entity_sum.hpp"
#include "rbvi/model/affine_coefficients.hpp"
#include "rbvi/model/online.hpp"
#include "rbvi/model/packed.hpp"
#include "tests/catalogue.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <tuple>

namespace rbvi::synthetic {

struct Sizes {
  int modes = 3, supremizers = 2, generators = 4;
  int a = 2, b = 1, f = 1, g = 1; ///< terms
};

inline Matrix random_matrix(std::mt19937 &random, Index rows, Index cols) {
  std::normal_distribution<double> normal;
  return Matrix::NullaryExpr(rows, cols, [&] { return normal(random); });
}

inline Matrix random_spd(std::mt19937 &random, Index n) {
  const Matrix factor = random_matrix(random, n, n);
  return factor * factor.transpose() / static_cast<double>(n) + Matrix::Identity(n, n);
}

/// `size` entries, each the sum of `per_entry` small cells of the disc (local entry 0).
inline SampleMesh random_sample(std::mt19937 &random, int size, int per_entry) {
  std::uniform_real_distribution<double> position(-0.1, 0.1);
  SampleMesh sample;
  sample.vertices.resize(size * per_entry * 3, 2);
  for (int cell = 0; cell < size * per_entry; ++cell) {
    const double x = position(random), y = position(random);
    sample.vertices.middleRows(3 * cell, 3) << x, y, x + 0.02, y + 0.004, x + 0.003, y + 0.03;
    sample.contributions.push_back({cell / per_entry, cell, 0});
  }
  sample.terms.assign(size * per_entry, 0);
  return sample;
}

inline AffineTerms random_terms(std::mt19937 &random, Index rows, int size, int per_entry) {
  AffineTerms terms;
  terms.reduced = random_matrix(random, rows, size);
  terms.interpolation = Matrix::Identity(size, size);
  terms.samples = {random_sample(random, size, per_entry)};
  return terms;
}

/// Sets what outputs and reconstruction need: a square of four triangles and `generators` hats.
inline void add_fields(std::mt19937 &random, ReducedModel &model) {
  const Index n = model.primal_size(), r = model.contact.generators;
  model.fields.points.resize(5, 2);
  model.fields.points << -0.1, -0.1, 0.1, -0.1, 0.1, 0.1, -0.1, 0.1, 0, 0;
  model.fields.cells = {0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4};
  model.fields.basis = random_matrix(random, 5, n);
  model.contact.dual_basis = random_matrix(random, 3, r).cwiseAbs();
  InterfaceModel contact;
  contact.nodes = {0, 1, 4};
  InterfaceMesh &triangle = contact.mesh;
  for (const int node : contact.nodes)
    triangle.points.push_back(point_of(model.fields.points, node));
  triangle.entities = triangle.dofs = {0, 1, 2};
  triangle.per_entity = 3;
  triangle.parts = {3};
  triangle.columns = 3;
  model.contact.trace = model.fields.basis(contact.nodes, Eigen::all);
  model.contact.interfaces = {contact};
}

inline bool same(const std::vector<InterfaceModel> &a, const std::vector<InterfaceModel> &b) {
  const auto members = [](const InterfaceModel &of) {
    const InterfaceMesh &mesh = of.mesh;
    return std::tie(mesh.dim, mesh.degree, mesh.components, mesh.points, mesh.entities,
                    mesh.per_entity, mesh.edges, mesh.parts, mesh.dofs, mesh.columns, of.nodes);
  };
  return std::ranges::equal(a, b, {}, members, members);
}

/// Lets entry q of every term set be local value q of one cell: theta_q = value(form, q, mu).
inline void sample_one_cell(AffineTerms &terms) {
  SampleMesh &sample = terms.samples.front();
  sample.vertices.resize(3, 2);
  sample.vertices << 0, 0, 1, 0, 0, 1;
  sample.contributions.clear();
  sample.terms = {0};
  for (int q = 0; q < terms.size(); ++q)
    sample.contributions.push_back({q, 0, q});
}

inline FullMu middle_of_box(const Scene &scene) {
  FullMu middle;
  for (const Parameter &p : scene.parameters.all)
    middle.push_back(0.5 * (p.lower + p.upper));
  return middle;
}

/// Divides each term by its theta in the middle of the box, so that all weigh alike there.
inline void scale_terms(AffineTerms &terms, const Vector &theta_in_the_middle) {
  for (int q = 0; q < terms.size(); ++q)
    terms.reduced.col(q) /= theta_in_the_middle[q];
}

/// Scene and sizes alone.
template <class Sizes> ReducedModel named_model(const Scene &scene, const Sizes &sizes) {
  ReducedModel model;
  model.scene = scene;
  model.body.modes = sizes.modes;
  model.body.supremizers = sizes.supremizers;
  model.contact.generators = sizes.generators;
  return model;
}

/// Strictly convex; in the middle of the box u = 0 is feasible (g >= 0), and g is a third of the
/// violation of the unconstrained minimum, so that about a third of the constraints bite.
inline ReducedModel random_model(const Sizes &sizes, unsigned seed, const Scene &scene,
                                 bool one_cell = false) {
  std::mt19937 random(seed);
  ReducedModel model = named_model(scene, sizes);
  const Index n = model.primal_size(), r = sizes.generators;
  model.body.a = random_terms(random, n * (n + 1) / 2, sizes.a, 4);
  Matrix a = Matrix::Zero(n, n);
  for (int q = 0; q < sizes.a; ++q) {
    const Matrix term = random_spd(random, n);
    a += term;
    model.body.a.reduced.col(q) = pack(term);
  }
  model.contact.b = random_terms(random, r * n, sizes.b, 1);
  model.body.f = random_terms(random, n, sizes.f, 1);
  model.contact.g = random_terms(random, r, sizes.g, 1);
  const Vector b = model.contact.b.reduced.rowwise().sum();
  const Matrix &loads = model.body.f.reduced;
  const Vector u = a.llt().solve(loads * Vector::Ones(loads.cols()));
  const double violation = (Eigen::Map<const Matrix>(b.data(), r, n) * u).norm();
  model.contact.g.reduced = model.contact.g.reduced.cwiseAbs();
  if (violation > 0)
    model.contact.g.reduced *= violation / (3 * model.contact.g.reduced.rowwise().sum().norm());
  if (one_cell)
    for (AffineTerms *terms : {&model.body.a, &model.contact.b, &model.body.f, &model.contact.g})
      sample_one_cell(*terms);
  add_fields(random, model);
  const FullMu mu = middle_of_box(scene);
  const Contact contact = contact_of(model, scene);
  scale_terms(model.body.a, affine_coefficients(model.body.a, scene.a, scene, mu));
  scale_terms(model.contact.b, contact_coefficients(model.contact.b, Part::b, contact, scene, mu));
  scale_terms(model.body.f, affine_coefficients(model.body.f, scene.f, scene, mu));
  scale_terms(model.contact.g, contact_coefficients(model.contact.g, Part::g, contact, scene, mu));
  return model;
}

inline ReducedModel random_model(const Sizes &sizes, unsigned seed) {
  return random_model(sizes, seed, make_scene("membrane_obstacle"));
}

using Value = double (*)(int form, int i, const FullMu &mu);

/// Contact in a region whose b and g have the values 1 and 3 of a toy scene.
template <Value value> class ToyContact : public EntitySum {
public:
  ToyContact(const Scene &scene, InterfaceMesh region) : EntitySum(scene, std::move(region), 2) {
    SparseMatrix gram(mesh_.nodes(), mesh_.nodes());
    gram.setIdentity();
    set_dual(mesh_.nodes(), 1, false, gram);
  }
  void integrate(const FullMu &mu, const Cell &, EntityValues &values) const override {
    for (int i = 0; i < 9; ++i)
      values.b.data()[i] = value(1, i, mu);
    for (int i = 0; i < 3; ++i)
      values.g[i] = value(3, i, mu);
  }
  void weigh(const FullMu &, const Cell &, EntityValues &values) const override {
    values.weights.setOnes();
  }
  PointConstraint constraint_at(const FullMu &, const Point &, const Point &,
                                const Point &) const override {
    return {{-1, 0, 0}, 0};
  }
  void outputs(const FullMu &, const ContactOperators &operators, const Vector &lambda,
               double least, Outputs &outputs) const override {
    pressure_outputs(Vector::Ones(lambda.size()), operators.weights, lambda, least, outputs);
  }
  Grid fields(const FullMu &, const Vector &, const Vector &, bool) override { return {}; }
};

/// A scene on the identity map whose forms fill their values from mu alone: value i of form k is
/// value(k, i, mu), k = 0 to 3 for a, b, f, g.
template <Value value> Scene toy_scene() {
  Scene scene = make_scene("membrane_obstacle");
  scene.map = [](const FullMu &, const Point &x) { return x; };
  const auto filled = [](int form, int count) {
    return [form, count](const FullMu &mu, const Cell &, double *values) {
      for (int i = 0; i < count; ++i)
        values[i] = value(form, i, mu);
    };
  };
  scene.a = {mapped_term({"", filled(0, 9)})};
  scene.f = {mapped_term({"", filled(2, 3)})};
  scene.contacts.front().make = [](const Scene &of, InterfaceMesh region) {
    return std::make_unique<ToyContact<value>>(of, std::move(region));
  };
  return scene;
}

} // namespace rbvi::synthetic
