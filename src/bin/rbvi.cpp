// rbvi: the MPI tool. `rbvi -help` lists commands and options.
#include "rbvi/core/error.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/par/interrupt.hpp"
#include "rbvi/par/session.hpp"
#include "rbvi/tool/commands.hpp"
#include "rbvi/tool/finish.hpp"

#include <cstdio>

namespace {

using namespace rbvi;

void print_options(const Invocation &invocation) {
  if (invocation.markdown)
    std::fputs(options_page().c_str(), stdout);
  else
    print_help(invocation.file, invocation.topic);
}

void run(const Invocation &invocation) {
  const std::string &command = invocation.command;
  const int rank = rank_of(PETSC_COMM_WORLD);
  if (command == "list" || command == "help" || command == "inspect") {
    if (rank != 0) return;
    if (command == "list") command_list();
    if (command == "help") print_options(invocation);
    if (command == "inspect") command_inspect(invocation.file);
    return;
  }
  const ToolOptions options = read_options(PETSC_COMM_WORLD, command);
  if (command == "offline") command_offline(options);
  if (command == "solve") command_solve(options);
  if (command == "verify") command_verify(options);
  if (command == "bench") command_bench(options);
}

} // namespace

int main(int argc, char **argv) {
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
    const int status = finish(PETSC_COMM_WORLD, [&] { run(invocation); });
    watch.stop();
    return status;
  } catch (const Error &error) { // PETSc does not start with these options
    const int status = finish(MPI_COMM_WORLD, [&] { throw bad_input(error.what()); });
    MPI_Finalize();
    return status;
  }
}
