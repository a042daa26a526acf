// The fields of model.h5 that bounds of errors are made of.
#pragma once

#include "model_fields.hpp"

namespace rbvi {

/// What bounds of errors are made of.
template <class Store, class Model> void list_certificate(const Store &store, Model &model) {
  auto &certificate = model.certificate;
  const Index contact = model.contact.interfaces.empty() ? 0 : model.contact_dofs(),
              terms = model.body.a.size();
  list_integer(store, "certificate/by_law", certificate.by_law);
  const Index loads = certificate.by_law ? model.body.f.size() : 0;
  store("certificate/of_loads", certificate.of_loads, Shape{loads, loads});
  store("certificate/left_of_loads", certificate.left_of_loads, Shape{loads, loads});
  store("certificate/dofs", certificate.dofs, Indices{contact});
  store("certificate/lifting_trace", certificate.lifting_trace);
  const Index lifting = certificate.lifting_trace.cols();
  store.ask("certificate/lifting_trace does not fit",
            [&] { return lifting == 0 || certificate.lifting_trace.rows() == contact; });
  store("certificate/own", certificate.own, Indices{static_cast<int>(lifting), any_size, -1});
  list_elements(
      store, "certificate/count", "certificate", certificate.references,
      [&](const std::string &at, auto &reference) {
        store(at + "/theta", reference.theta, Shape{terms, 1});
        store(at + "/of_basis", reference.of_basis, Shape{any_size, terms * model.primal_size()});
        store(at + "/of_lifting", reference.of_lifting, Shape{any_size, terms * lifting});
        store(at + "/of_contact", reference.of_contact,
              Shape{any_size, std::ssize(certificate.dofs)});
        store(at + "/of_loads", reference.of_loads, Shape{any_size, model.body.f.size()});
        store.ask(at + " has other coordinates", [&] {
          return reference.of_basis.rows() <= reference.of_lifting.rows() &&
                 reference.of_lifting.rows() <= reference.of_contact.rows() &&
                 reference.of_contact.rows() <= reference.of_loads.rows();
        });
      });
  store.ask("certificate/own does not fit", [&] {
    return certificate.references.empty() ||
           std::ssize(certificate.own) == model.contact.dual_basis.rows();
  });
}

} // namespace rbvi
