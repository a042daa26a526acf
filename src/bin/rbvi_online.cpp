#include "rbvi/model/online_tool.hpp"
#include "rbvi/model/published/queries.hpp"

int main(int argc, char **argv) {
  rbvi::add_published_queries();
  return rbvi::rbvi_online_main(argc, argv, {});
}
