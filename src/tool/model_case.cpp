#include "model_case.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/core/validity.hpp"
#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/model/training_samples.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/scene/stored_scene.hpp"

#include <algorithm>
#include <cstdio>
#include <set>

namespace rbvi {

namespace {

namespace fs = std::filesystem;

/// "[0.16, 0.24]" or "0.2"
std::string range_of(const ParameterSpace &space, std::size_t i) {
  const Parameter &p = space.all[i];
  const bool free =
      std::find(space.free.begin(), space.free.end(), static_cast<int>(i)) != space.free.end();
  return free ? describe(Range{p.lower, p.upper}) : shortest_number(p.value);
}

bool same_range(const ParameterSpace &one, const ParameterSpace &two, std::size_t i) {
  const auto free = [&](const ParameterSpace &space) {
    return std::find(space.free.begin(), space.free.end(), static_cast<int>(i)) != space.free.end();
  };
  const Parameter &p = one.all[i], &q = two.all[i];
  if (free(one) != free(two)) return false;
  return free(one) ? p.lower == q.lower && p.upper == q.upper : p.value == q.value;
}

std::string setting(const ReducedModel &model, const std::string &name) {
  const auto found = model.made.settings.find(name);
  return found == model.made.settings.end() ? "" : found->second;
}

/// Whether the case trains at other parameters. A set that cannot be read is not needed.
bool other_training(const OfflineOptions &options, const ReducedModel &model) {
  if (options.train == setting(model, "training")) return false;
  std::vector<Mu> own = from_columns(model.made.trained_mu);
  for (Mu &mu : from_columns(model.made.failed_mu))
    own.push_back(std::move(mu));
  try {
    std::vector<Mu> given =
        parse_set(options.scene.parameters, options.train, false, options.scene.outputs);
    std::sort(given.begin(), given.end());
    std::sort(own.begin(), own.end());
    return given != own;
  } catch (const Error &) {
    return false;
  }
}

/// The mesh of the model, where its file is still there.
MeshOptions mesh_of(const ReducedModel &model, MeshOptions mesh) {
  const std::string refine = setting(model, "mesh_refine"), file = setting(model, "mesh_file");
  std::error_code ignored;
  if (!refine.empty()) mesh.refine = static_cast<int>(parse_number(refine, "mesh_refine"));
  if (file.empty() || fs::exists(file, ignored)) mesh.file = file;
  return mesh;
}

/// "name VALUE instead of VALUE" for each difference.
std::vector<std::string> differences(const OfflineOptions &given, const OfflineOptions &own,
                                     const ReducedModel &model) {
  std::vector<std::string> list;
  const auto differ = [&](const std::string &name, const std::string &mine,
                          const std::string &theirs) {
    list.push_back(name + " " + mine + " instead of " + theirs);
  };
  const ParameterSpace &mine = own.scene.parameters, &theirs = given.scene.parameters;
  for (std::size_t i = 0; i < mine.all.size(); ++i)
    if (!same_range(mine, theirs, i))
      differ(mine.all[i].name, range_of(mine, i), range_of(theirs, i));
  for (const auto &[name, value] : own.scene.options)
    if (const auto other = given.scene.options.find(name);
        other != given.scene.options.end() && other->second != value)
      differ(name, value, other->second);
  if (own.mesh.refine != given.mesh.refine)
    differ("mesh_refine", std::to_string(own.mesh.refine), std::to_string(given.mesh.refine));
  std::error_code ignored;
  if (own.mesh.file != given.mesh.file && !fs::equivalent(own.mesh.file, given.mesh.file, ignored))
    differ("mesh", own.mesh.file.empty() ? "built in" : own.mesh.file,
           given.mesh.file.empty() ? "built in" : given.mesh.file);
  if (other_training(given, model)) differ("train", setting(model, "training"), given.train);
  return list;
}

} // namespace

ReducedModel model_of_run(MPI_Comm world, const OfflineOptions &options) {
  if (options.out.empty()) throw bad_input("no run directory is named: use -out run/NAME");
  const fs::path file = options.out / "model.h5";
  ReducedModel model;
  collectively(world, [&] {
    if (!fs::exists(file))
      throw bad_input(file.string() + " does not exist: make it by rbvi offline first");
    model = read_model(file, *options.registry);
  });
  if (options.reduce.online_method == OnlineMethod::exact)
    model.made.settings.erase("online_method");
  else
    model.made.settings["online_method"] =
        online_method_names()[static_cast<std::size_t>(options.reduce.online_method)];
  return model;
}

MeasureOptions adopt_model(MeasureOptions options, const ReducedModel &model) {
  const OfflineOptions given = options;
  Scene stored = model.scene;
  stored.name = options.scene.name; // that of a folder, which may be renamed
  try {
    options.scene =
        in_box_of(stored, make_scene(entry_of(*options.registry, stored.name), stored.options));
  } catch (const Error &error) {
    throw bad_input("the model in " + options.out.string() + " is one of scene " +
                    model.scene.name + ", the case names " + stored.name +
                    ": leave out -case, or use another -out (" + error.what() + ")");
  }
  options.mesh = mesh_of(model, options.mesh);
  std::string line;
  for (const std::string &difference : differences(given, options, model))
    line += (line.empty() ? "" : ", ") + difference;
  if (rank_of(PETSC_COMM_WORLD) == 0 && !line.empty())
    std::printf("The model is not of this case, and its own values are used: %s\n", line.c_str());
  return options;
}

std::vector<Mu> validation_set(const MeasureOptions &options, const ReducedModel &model) {
  std::vector<Mu> set =
      parse_set(options.scene.parameters, options.valid, false, options.scene.outputs);
  check_set(options.scene, set);
  const std::vector<Mu> list = from_columns(model.made.trained_mu);
  const std::set<Mu> trained(list.begin(), list.end());
  const auto seen = std::ranges::count_if(set, [&](const Mu &mu) { return trained.contains(mu); });
  if (seen > 0 && rank_of(PETSC_COMM_WORLD) == 0)
    std::printf(
        "warning: at %td of %zu validation parameters the model was trained, and its errors "
        "there say nothing of others: give another -valid (of a random set another seed)\n",
        seen, set.size());
  return set;
}

void check_problem(const Problem &problem, const ReducedModel &model, const fs::path &out) {
  const std::string its = "the model in " + out.string();
  const std::string file = setting(model, "mesh_file");
  if (problem.mesh().fingerprint != model.made.mesh_fingerprint)
    throw bad_input(its + " was made on another mesh" +
                    (file.empty() ? "" : ", that of " + file + " then: give it by -mesh"));
  const std::string difference = scene_difference(model.scene.tree, problem.scene().tree);
  if (!difference.empty())
    throw bad_input(its + " is of another scene: " + difference +
                    ": make it again by rbvi offline with another -out");
}

} // namespace rbvi
