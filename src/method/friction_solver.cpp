#include "friction_normal.hpp"
#include "friction_run.hpp"
#include "rbvi/core/error.hpp"

namespace rbvi {

namespace {

using namespace friction;

void check(const Vector &q, const NodeLaws &laws, const Vector &start) {
  if (q.size() != laws.rows)
    throw failure("friction: the right-hand side has " + std::to_string(q.size()) +
                  " entries, and the laws " + std::to_string(laws.rows));
  if (start.size() != 0 && start.size() != q.size())
    throw failure("friction: the first guess has " + std::to_string(start.size()) +
                  " entries instead of " + std::to_string(q.size()));
  if (!q.allFinite()) throw failure("friction: the right-hand side is not finite");
  if (!start.allFinite()) throw failure("friction: the first guess is not finite");
}

} // namespace

struct FrictionSolver::Parts {
  Parts(LazyColumns of, const NodeLaws &by) : laws(by), h(std::move(of)) { rbvi::check(laws); }
  FrictionAnswer run(const Vector &start, bool rule, bool searches) {
    check(q, laws, start);
    if (laws.friction()) return run_friction(h, q, laws, options, kept, start, rule, searches);
    return {without_friction(h, q, laws, start, options)};
  }

  const NodeLaws laws;
  LazyColumns h;
  Vector q; ///< of the last answer
  FrictionOptions options;
  bool by_rule = false;
  Kept kept;

  /// The last answer(), and the system of its active sets once that is asked for.
  struct Answered {
    Vector x, start;
    std::optional<ActiveSets> sets; ///< empty: without friction, where x tells them
    std::optional<System> tangent{};
  };
  std::optional<Answered> last;
  /// Of the last answer().
  const System &tangent();
};

FrictionSolver::FrictionSolver(ColumnSource columns, const NodeLaws &laws)
    : parts_(std::make_unique<Parts>(LazyColumns(std::move(columns), laws.rows), laws)) {}

FrictionSolver::FrictionSolver(const ScaledMatrix &h, const NodeLaws &laws)
    : parts_(std::make_unique<Parts>(LazyColumns(h), laws)) {}

FrictionSolver::~FrictionSolver() = default;

FrictionAnswer FrictionSolver::answer(const Vector &q, const Vector &start, bool by_rule,
                                      const FrictionOptions &options) {
  parts_->q = q;
  parts_->options = options;
  parts_->by_rule = by_rule;
  parts_->kept.known.clear();
  parts_->last.reset();
  FrictionAnswer answer = parts_->run(start, by_rule, false);
  if (!answer.converged) return answer;
  parts_->last = {answer.x, answer.start, std::move(parts_->kept.sets)};
  return answer;
}

const friction::System &FrictionSolver::Parts::tangent() {
  if (!last) throw failure("friction: there is no answer to go on from");
  if (!last->tangent)
    last->tangent.emplace(h, laws, last->sets ? *last->sets : contact_sets(laws, last->x));
  return *last->tangent;
}

NearAnswer FrictionSolver::near(const Vector &left, const NodeLaws &laws) const {
  const System &tangent = parts_->tangent();
  const LazyColumns &h = parts_->h;
  const Parts::Answered &last = *parts_->last;
  State point = tangent.near(h, last.x, parts_->laws, left, laws);
  if (!point.x.allFinite()) throw failure("friction: what touches does not tell its tractions");
  const Vector start = smooth_start(h.diagonal(), laws, point);
  return {std::move(point.x), std::move(point.w), start,
          predicted_sets(laws, start).key() == predicted_sets(parts_->laws, last.start).key()};
}

FrictionAnswer FrictionSolver::another(const Vector &start, bool by_rule) {
  return parts_->run(start, by_rule, true);
}

Matrix FrictionSolver::change(const Matrix &of_q, bool anew) const {
  const std::optional<System> &system = parts_->kept.system;
  if (!system && !anew) return {};
  return (system ? *system : parts_->tangent()).change(parts_->laws, of_q);
}

const NodeLaws &FrictionSolver::laws() const {
  return parts_->laws;
}

bool FrictionSolver::by_rule() const {
  return parts_->by_rule;
}

} // namespace rbvi
