#include "rbvi/model/print.hpp"

#include "rbvi/core/output_units.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/model/law_solver.hpp"
#include "rbvi/model/self_check.hpp"
#include "rbvi/model/training_samples.hpp"

#include <algorithm>
#include <iomanip>
#include <sstream>
#include <utility>

namespace rbvi {

namespace {

constexpr std::size_t label_width = 22;

std::ostream &label(std::ostream &out, const std::string &text) {
  out << std::left << std::setw(int{label_width}) << text;
  return text.size() < label_width ? out : out << ' ';
}

std::string names_and_values(const std::map<std::string, std::string> &map) {
  std::string text;
  for (const auto &[key, value] : map)
    if (!value.empty()) text += (text.empty() ? "" : ", ") + key + " " + value;
  return text.empty() ? "-" : text;
}

std::string validation(const ValidationErrors &errors) {
  std::ostringstream text;
  if (errors.count > 0) {
    text << std::setprecision(2) << "u " << errors.u_mean << " mean, " << errors.u_max
         << " largest; lambda " << errors.lambda_mean << " mean, " << errors.lambda_max
         << " largest; ";
    if (errors.tangential_mean >= 0)
      text << "lambda_tau " << errors.tangential_mean << " mean, " << errors.tangential_max
           << " largest; ";
    text << "over " << errors.count << " parameters, relative";
  }
  if (errors.unanswered > 0)
    text << (errors.count > 0 ? "; " : "") << "no answer at " << errors.unanswered
         << (errors.count > 0 ? " more" : " validation parameters, all of them");
  return text.str().empty() ? "not measured: nobody knows how far this model is from "
                              "high-fidelity answers until rbvi verify compares them"
                            : text.str();
}

void print_parameters(std::ostream &out, const ParameterSpace &space) {
  for (std::size_t i = 0; i < space.all.size(); ++i) {
    const Parameter &p = space.all[i];
    const bool is_free =
        std::find(space.free.begin(), space.free.end(), static_cast<int>(i)) != space.free.end();
    label(out, i == 0 ? "parameters" : "") << std::setw(int{label_width}) << p.name;
    if (is_free && !p.choices.empty())
      out << joined(p.choices, " or ");
    else if (is_free)
      out << '[' << p.lower << ", " << p.upper << ']';
    else
      out << p.value << " (fixed)";
    out << (p.unit.empty() ? "" : " ") << p.unit << '\n';
  }
}

void print_terms(std::ostream &out, const std::string &name, const AffineTerms &terms) {
  const int interpolated = terms.size() - terms.exact;
  label(out, "terms of " + name) << terms.size();
  if (terms.exact > 0 && interpolated == 0) out << " (exact sum)";
  if (terms.exact > 0 && interpolated > 0) out << " (" << terms.exact << " exact)";
  if (interpolated > 0) out << " (interpolation error " << terms.error << ')';
  out << '\n';
}

/// B^n and B^tau apart.
void print_terms_of_rows(std::ostream &out, int terms, const TermsApart &apart) {
  label(out, "terms of b") << apart.normal << " of B^n (interpolation error " << apart.normal_error
                           << "), " << terms - apart.normal << " of B^tau (interpolation error "
                           << apart.tangential_error << ")\n";
}

void print_law(std::ostream &out, const NodalLaw &law, int multipliers) {
  label(out, "condensed operator")
      << multipliers << " x " << multipliers << ", " << law.condensed.terms.cols() << " terms";
  if (!law.condensed.grid.axes.empty())
    out << " (interpolation error " << law.condensed.error << ')';
  out << '\n';
}

void print_nitsche(std::ostream &out, const ReducedModel &model) {
  label(out, "contact curve") << describe_curve(model) << '\n';
  label(out, "terms of a_gamma - a") << consistency_terms(model) << '\n';
}

/// "140", of each boundary: "281 + 281".
std::string nodes_of_interfaces(const ReducedModel &model) {
  std::string text;
  for (const InterfaceModel &interface : model.contact.interfaces)
    for (const int nodes : interface.mesh.parts)
      text += (text.empty() ? "" : " + ") + std::to_string(nodes);
  return text;
}

/// Where the model has no sample, though it was to have one.
void print_failed(std::ostream &out, const ReducedModel &model) {
  constexpr std::size_t most = 10;
  const std::vector<Mu> failed = from_columns(model.made.failed_mu);
  if (failed.empty()) return;
  label(out, "failed samples") << failed.size() << " of "
                               << failed.size() +
                                      static_cast<std::size_t>(model.made.trained_mu.cols())
                               << ", without a high-fidelity answer at\n";
  for (std::size_t k = 0; k < std::min(most, failed.size()); ++k)
    label(out, "") << describe(model.scene.parameters, failed[k]) << '\n';
  if (failed.size() > most) label(out, "") << "and " << failed.size() - most << " more\n";
}

/// Name, unit, the largest error that was measured, and what it is; checks of an answer left out.
void print_columns(std::ostream &out, const ReducedModel &model) {
  const ErrorOfOutput errors = errors_of_outputs(model);
  bool first = true;
  for (const OutputColumn &column : columns_of_model(model)) {
    if (column.kind == OutputKind::check) continue;
    const std::string unit = unit_of(model.scene, column), says = says_of(model.scene, column);
    label(out, std::exchange(first, false) ? "outputs" : "") << column.name;
    if (!unit.empty()) out << " (" << unit << ')';
    if (!says.empty()) out << ": " << says;
    if (const auto found = errors.find(column.name); found != errors.end())
      out << "; largest error " << short_number(found->second);
    out << '\n';
  }
}

} // namespace

void print_expected_errors(std::ostream &out, const ReducedModel &model) {
  label(out, "expected error") << validation(expected_errors(model)) << '\n';
}

void print_model(std::ostream &out, const ReducedModel &model) {
  label(out, "scene") << model.scene.name << '\n';
  label(out, "options") << names_and_values(model.scene.options) << '\n';
  print_parameters(out, model.scene.parameters);
  print_columns(out, model);
  print_failed(out, model);
  label(out, "modes") << model.body.modes << '\n';
  const bool joined = model.contact.law && !model.contact.law->on_functions();
  label(out, joined ? "displacements under unit loads" : "supremizers")
      << model.body.supremizers << (model.body.online_enriched ? " (the space is made online)" : "")
      << '\n';
  if (!model.has_multipliers())
    print_nitsche(out, model);
  else if (model.contact.law)
    print_law(out, *model.contact.law, model.contact.generators);
  else
    label(out, "functions >= 0") << model.contact.generators - model.contact.free_modes << '\n';
  if (model.contact.free_modes > 0)
    label(out, "functions of either sign") << model.contact.free_modes << '\n';
  print_terms(out, "a", model.body.a);
  print_terms(out, "f", model.body.f);
  if (!model.has_multipliers()) {
    label(out, "b, g") << "none: Nitsche's method\n";
  } else if (model.evaluates_contact()) {
    label(out, "b, g") << "assembled for each mu on " << nodes_of_interfaces(model)
                       << " contact nodes\n";
  } else {
    if (model.contact.law && model.contact.law->apart.normal > 0)
      print_terms_of_rows(out, model.contact.b.size(), model.contact.law->apart);
    else
      print_terms(out, "b", model.contact.b);
    if (model.evaluates_gap())
      label(out, "g") << "assembled for each mu on " << nodes_of_interfaces(model)
                      << " contact nodes\n";
    else
      print_terms(out, "g", model.contact.g);
  }
  label(out, "multipliers") << model.contact.dual_basis.rows() << '\n';
  label(out, "mesh") << model.made.mesh_fingerprint << '\n';
  for (const auto &[name, value] : model.made.settings)
    label(out, name) << value << '\n';
  print_expected_errors(out, model);
  label(out, "self-check");
  print_self_check(out, model.made.self_check, model.scene.parameters);
  print_several_answers(out, model);
  warn_of_balance(out, model);
  if (model.body.supremizers > 0)
    label(out, "  modes alone") << validation(model.made.validation_decorrelated) << '\n';
}

namespace {

/// A value that the self-check keeps, and its parameters, to the digits that people read.
std::array<std::string, 2> worst_of(const ReducedModel &model, const std::string &history) {
  std::vector<double> known = model.made.histories.at(history);
  for (double &value : known)
    value = parse_number(short_number(value), "parameter");
  return {short_number(known.front()),
          describe(model.scene.parameters, Mu(known.begin() + 1, known.end()))};
}

} // namespace

void print_several_answers(std::ostream &out, const ReducedModel &model) {
  if (!has_several_answers(model)) return;
  const auto [apart, at] = worst_of(model, "self_check/other");
  const bool reduced = model.contact.law->on_functions();
  out << "  the " << (reduced ? "reduced " : "") << "law of friction has several answers, " << apart
      << " of the largest multiplier apart at " << at << ": a query takes "
      << (reduced
              ? "the one that the nearest training parameter leads to"
              : "the one by rule (OUTPUTS.md), as a full solve, and says where there are others")
      << '\n';
}

void warn_of_balance(std::ostream &out, const ReducedModel &model) {
  if (!model.made.histories.contains("self_check/balance")) return;
  const auto [left, at] = worst_of(model, "self_check/balance");
  out << "warning: forces on a body, its reactions among them, miss their balance by up to " << left
      << " of the largest (" << at << "): reactions are no more exact than that; use more training "
      << "parameters, or smaller tolerances\n";
}

void warn_of_other_answers(std::ostream &out, long not_alone, long all) {
  if (not_alone == 0) return;
  out << "warning: "
      << (all == 1 ? "the answer is not the only one"
                   : std::to_string(not_alone) + " of " + std::to_string(all) +
                         " answers are not the only ones at their parameters")
      << ": the law of friction has others with this coefficient or threshold\n";
}

void print_written(std::ostream &out, const std::vector<std::filesystem::path> &paths) {
  for (std::size_t i = 0; i < paths.size(); ++i)
    out << (i == 0 ? "wrote " : ", ") << paths[i].string();
  out << '\n';
}

} // namespace rbvi
