// A small model of the membrane that has everything a file can hold.
#pragma once

#include "synthetic.hpp"

namespace rbvi {

inline ReducedModel full_model() {
  ReducedModel model = synthetic::random_model({3, 2, 4, 3, 2, 1, 2}, 11);
  model.scene.parameters = free_only(model.scene.parameters, "radius,center_y");
  model.scene.parameters.all[1].value = 0.01;
  model.made.settings = {{"-pod_tolerance", "1e-3"}, {"-cone", "mcpg"}};
  model.made.mesh_fingerprint = "0123456789abcdef";
  model.contact.free_modes = 1;
  model.body.a.error = 1e-3;
  model.made.histories = {{"pod/error", {1, 0.1}}, {"cone/e_orth", {}}};
  model.made.stage_seconds = {{"snapshots", 12.5}};
  model.made.validation_enriched = {64, 1e-4, 2e-4, 3e-4, 4e-4};
  model.made.validation_enriched.outputs = {{"energy", 1, 2, 3, 4, 5, 6},
                                            {"kkt_residual", 0, 1e-15, 0, 0, 0, 0}};
  model.made.validation_enriched.unanswered = 2;
  model.made.validated_mu = Matrix::Constant(2, 66, 0.02);
  model.made.self_check = {
      200, 3, {0.2, 0.01}, "contact opens", {1e-12, {0.17, 0}}, {1e-3, {0.2, 0}}, {}, 8, 0.25};
  return model;
}

} // namespace rbvi
