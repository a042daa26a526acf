#include "rbvi/tool/other_outputs.hpp"

#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/model/scene_record.hpp"
#include "rbvi/model/scene_text.hpp"
#include "rbvi/model/training_samples.hpp"
#include "rbvi/par/collective.hpp"

#include <algorithm>

namespace rbvi {

namespace {

/// Of the outputs alone.
std::map<std::string, std::string> lines_of_outputs(const Scene &scene) {
  Record record = record_of(scene);
  std::erase_if(record.parts, [](const auto &part) { return !part.first.starts_with("output_"); });
  return lines_of(record);
}

bool same_box(const ParameterSpace &one, const ParameterSpace &two) {
  return one.free == two.free &&
         std::ranges::equal(one.all, two.all, [](const Parameter &p, const Parameter &q) {
           return p.name == q.name && p.lower == q.lower && p.upper == q.upper &&
                  p.value == q.value;
         });
}

/// Whether reducing these samples would make this model again, but for its outputs.
bool is_made_of(const ReducedModel &model, const OfflineOptions &options, const Problem &problem,
                const Sweep &sweep) {
  std::map<std::string, std::string> settings = kept_settings(options), own = model.made.settings;
  settings[whole_scene] = scene_text(problem.scene(), problem.contact());
  settings["samples"] = std::to_string(sweep.samples.size());
  for (auto *of : {&settings, &own})
    of->erase("cone_ring"); // what it was widened to
  const std::vector<Mu> mus = parameters_of(sweep.samples);
  const bool reaches = model.contact.trace_dofs.empty() || problem.scene().outputs.empty();
  return settings == own && from_columns(model.made.trained_mu) == mus && reaches &&
         same_box(model.scene.parameters, problem.scene().parameters) &&
         model.made.mesh_fingerprint == problem.mesh().fingerprint;
}

/// The rows of fields at some nodes.
Matrix rows_at(const Matrix &fields, const std::vector<int> &nodes, Index components) {
  Matrix rows(std::ssize(nodes) * components, fields.cols());
  for (std::size_t k = 0; k < nodes.size(); ++k)
    rows.middleRows(static_cast<Index>(k) * components, components) =
        fields.middleRows(nodes[k] * components, components);
  return rows;
}

std::optional<ReducedModel> read_kept(const OfflineOptions &options, const Problem &problem,
                                      const Sweep &sweep) {
  const std::filesystem::path path = options.out / "model.h5";
  try {
    ReducedModel model = read_model(path, *options.registry, false);
    const Scene &scene = problem.scene();
    if (!is_made_of(model, options, problem, sweep) ||
        lines_of_outputs(model.scene) == lines_of_outputs(scene))
      return std::nullopt;
    model.outputs = {problem.output_cells(), {}};
    if (const std::vector<int> &nodes = model.outputs.cells.nodes; !nodes.empty()) {
      ReducedModel with_fields = read_model(path, *options.registry);
      model.outputs.basis = rows_at(with_fields.fields.basis, nodes, scene.components);
    }
    model.scene = scene;
    model.made.validation_enriched = model.made.validation_decorrelated = {}; // of other outputs
    model.made.validated_mu = {};
    return model;
  } catch (const Error &) { // none, or one of another version
    return std::nullopt;
  }
}

} // namespace

std::optional<ReducedModel> with_other_outputs(MPI_Comm world, const OfflineOptions &options,
                                               const Problem &problem, const Sweep &sweep) {
  if (!options.registry || sweep.report.solved > 0) return std::nullopt;
  std::optional<ReducedModel> model;
  int found = 0;
  if (rank_of(world) == 0) {
    model = read_kept(options, problem, sweep);
    found = model.has_value() ? 1 : 0;
  }
  MPI_Bcast(&found, 1, MPI_INT, 0, world);
  if (found != 0 && !model) model.emplace();
  return model;
}

} // namespace rbvi
