#include "rbvi/tool/rbvi_main.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/par/interrupt.hpp"
#include "rbvi/par/session.hpp"
#include "rbvi/tool/commands.hpp"
#include "rbvi/tool/finish.hpp"

#include <cstdio>

namespace rbvi {

namespace {

void command_help(const Invocation &invocation, const Registry &registry) {
  if (invocation.json)
    std::fputs(options_dump(registry).c_str(), stdout);
  else
    print_help(registry, invocation.file, invocation.topic);
}

void run_command(const Invocation &invocation, const Registry &registry) {
  const std::string &command = invocation.command;
  const int rank = rank_of(PETSC_COMM_WORLD);
  if (command == "list" || command == "help" || command == "inspect" || command == "new" ||
      command == "compare") {
    if (rank != 0) return;
    if (command == "list") command_list(invocation.file, registry);
    if (command == "help") command_help(invocation, registry);
    if (command == "new") command_new(invocation.file, invocation.topic);
    if (command == "compare") command_compare(invocation.files, invocation.topic, registry);
    if (command == "inspect") command_inspect(invocation.file, registry);
    return;
  }
  const ToolOptions options = read_options(PETSC_COMM_WORLD, command, registry);
  if (command == "offline") command_offline(options);
  if (command == "check") command_check(options, options);
  if (command == "run") command_run(options);
  if (command == "solve") command_solve(options, options);
  if (command == "verify") command_verify(options);
  if (command == "bench") command_bench(options);
}

} // namespace

int rbvi_main(int argc, char **argv, const Registry &registry) {
  const Invocation invocation = read_invocation(argc, argv);
  // A line at a time, into files and pipes too: what is said is there when the process is ended.
  (void)std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);
  if (invocation.status) return report_once(*invocation.status, invocation.message);
  try {
    std::vector<char *> arguments = invocation.pointers();
    int count = static_cast<int>(arguments.size()) - 1;
    char **values = arguments.data();
    InterruptWatch watch;
    Session session(count, values);
    watch.start(rank_of(PETSC_COMM_WORLD) == 0);
    const int status = finish(PETSC_COMM_WORLD, [&] { run_command(invocation, registry); });
    watch.stop();
    return status;
  } catch (const Error &error) { // PETSc does not start with these options
    const int status = finish(MPI_COMM_WORLD, [&] { throw bad_input(error.what()); });
    MPI_Finalize();
    return status;
  }
}

} // namespace rbvi
