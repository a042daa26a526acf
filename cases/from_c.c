/* Forces at some indentations, from the model that stands on the command line: cc from_c.c -lrbvi. */
#include <rbvi.h>
#include <stdio.h>
#include <stdlib.h>

static void check(rbvi_status status) {
  if (status == RBVI_OK) return;
  fprintf(stderr, "%s\n", rbvi_error());
  exit(status);
}

int main(int count, char **arguments) {
  rbvi_model *model = NULL;
  rbvi_workspace *workspace = NULL;
  check(rbvi_open(count > 1 ? arguments[1] : "model.rbvi", &model));
  check(rbvi_workspace_new(model, &workspace));
  const size_t parameters = rbvi_parameter_count(model), outputs = rbvi_output_count(model);
  double *mu = calloc(parameters, sizeof *mu), *values = calloc(outputs, sizeof *values);
  for (size_t i = 0; i < parameters; ++i) {
    rbvi_parameter of;
    check(rbvi_parameter_at(model, i, &of));
    mu[i] = i + 2 < (size_t)count ? atof(arguments[i + 2]) : of.value;
    printf("%s %.17g %s\n", of.name, mu[i], of.unit);
  }
  check(rbvi_solve(workspace, mu, 0));
  check(rbvi_outputs(workspace, values));
  for (size_t i = 0; i < outputs; ++i) {
    rbvi_output of;
    check(rbvi_output_at(model, i, &of));
    printf("%s %.17g\n", of.name, values[i]);
  }
  free(mu), free(values);
  rbvi_workspace_free(workspace), rbvi_close(model);
  return 0;
}
