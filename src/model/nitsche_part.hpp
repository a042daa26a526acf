// The part of Nitsche's method in a reduced model.
#pragma once

#include "rbvi/io/fields.hpp"
#include "rbvi/model/model.hpp"

#include <algorithm>

namespace rbvi {

/// Cells beside the curves.
Index curve_cells(const ReducedModel &model);

class BasisChange;
/// Where there is such a part.
void change_nitsche(const BasisChange &to, ReducedModel &model);

/// `entries`: of the reduced operator; `dofs`: at the contact.
template <class Store, class Terms>
void list_layer_terms(const Store &store, const std::string &name, Terms &terms, Index entries,
                      Index dofs) {
  const Index size = terms.size();
  store(name + "/interpolation", terms.interpolation, Shape{size, size});
  store(name + "/reduced", terms.reduced, Shape{size == 0 ? any_size : entries, size});
  store(name + "/rows", terms.rows, Indices{dofs, size});
  store(name + "/columns", terms.columns, Indices{dofs, terms.columns.empty() ? 0 : size});
  store(name + "/error", terms.error);
}

/// The fields of model.h5 (model_list.hpp).
template <class Store, class Model> void list_nitsche(const Store &store, Model &model) {
  int rule = model.contact.nitsche ? static_cast<int>(model.contact.nitsche->rule) : -1;
  store("nitsche/rule", rule,
        Between{model.contact.nitsche ? 0 : -1, static_cast<int>(CurveRule::interpolated)});
  if (rule < 0) return;
  if constexpr (Store::reads) model.contact.nitsche.emplace().rule = static_cast<CurveRule>(rule);
  auto &nitsche = *model.contact.nitsche;
  const Index n = model.primal_size(), packed = n * (n + 1) / 2, dofs = model.contact.trace.rows(),
              starts = nitsche.starts.cols();
  const bool interpolated = nitsche.rule == CurveRule::interpolated;
  store("nitsche/points", nitsche.points, Indices{4 * curve_cells(model)});
  store.ask("nitsche/points are not in order",
            [&] { return std::ranges::is_sorted(nitsche.points); });
  store("nitsche/factors", nitsche.factors, Shape{std::ssize(nitsche.points), 1});
  store("nitsche/starts", nitsche.starts, Shape{interpolated ? n : any_size, any_size});
  store("nitsche/starts_mu", nitsche.starts_mu, Shape{model.scene.parameters.size(), starts});
  const bool follows = nitsche.states.size() > 0;
  store("nitsche/states", nitsche.states, follows ? Shape{n, starts} : Shape{any_size, any_size});
  list_layer_terms(store, "nitsche/consistency", nitsche.consistency, packed, dofs);
  list_layer_terms(store, "nitsche/contact_matrix", nitsche.contact_matrix, packed, dofs);
  list_layer_terms(store, "nitsche/contact_vector", nitsche.contact_vector, n, dofs);
  list_layer_terms(store, "nitsche/friction_matrix", nitsche.friction_matrix, packed, dofs);
  list_layer_terms(store, "nitsche/friction_vector", nitsche.friction_vector, n, dofs);
}

} // namespace rbvi
