/* Answers of a reduced model in C, without MPI, PETSc and HDF5: link librbvi (pkg-config rbvi).
 *
 *   rbvi_model *model;
 *   rbvi_workspace *workspace;
 *   rbvi_open("model.rbvi", &model);         // rbvi-online model.h5 --pack model.rbvi
 *   rbvi_workspace_new(model, &workspace);
 *   rbvi_solve(workspace, mu, 0);            // rbvi_parameter_count(model) numbers
 *   rbvi_outputs(workspace, values);         // rbvi_output_count(model) numbers
 *
 * A function that can fail returns a status; rbvi_error() says in one line what to do. Any number of
 * threads may use one model; a workspace is for one thread at a time. Numbers are in the units that
 * the parameters and outputs have. What is not known is NaN. Handles that were closed, and null, are
 * refused. */
#ifndef RBVI_H
#define RBVI_H

#include <stddef.h>

#if defined(_WIN32) && defined(RBVI_BUILD)
#define RBVI_API __declspec(dllexport)
#elif defined(_WIN32)
#define RBVI_API __declspec(dllimport)
#else
#define RBVI_API __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

#define RBVI_INTERFACE 1 /* of this header: functions are added to it, none changes */

typedef struct rbvi_model rbvi_model;         /* what a file holds; never changes */
typedef struct rbvi_workspace rbvi_workspace; /* one answer, and the memory that it takes */

typedef enum rbvi_status {
  RBVI_OK = 0,
  RBVI_NO_ANSWER = 1, /* the method has none at this parameter, or something failed */
  RBVI_BAD_INPUT = 2, /* the call, its numbers or the file are wrong */
  RBVI_BUSY = 3       /* another thread uses the workspace */
} rbvi_status;

typedef enum rbvi_option {
  RBVI_EXTRAPOLATE = 1 /* parameters outside of the box are answered, without expected errors */
} rbvi_option;

/* The version of the library. */
RBVI_API const char *rbvi_version(void);
/* Why the last call of this thread failed, one line; "" where it did not. Valid until the next. */
RBVI_API const char *rbvi_error(void);

/* An image of a model, from a file or from memory, which is copied. */
RBVI_API rbvi_status rbvi_open(const char *file, rbvi_model **model);
RBVI_API rbvi_status rbvi_open_memory(const void *image, size_t size, rbvi_model **model);
/* Workspaces of it stay valid. */
RBVI_API void rbvi_close(rbvi_model *model);

/* Texts belong to the model. */
typedef struct rbvi_parameter {
  const char *name, *unit, *says; /* "" where there is none */
  double lower, upper;            /* of the box that the model was made for */
  double value;                   /* the default */
} rbvi_parameter;

typedef enum rbvi_output_kind {
  RBVI_QUANTITY = 0, /* as accurate as the fields */
  RBVI_MEASURE = 1,  /* counted along the contact, to an edge of the mesh */
  RBVI_CHECK = 2     /* of the answer itself: residuals, violations, steps */
} rbvi_output_kind;

typedef struct rbvi_output {
  const char *name, *unit, *says;
  rbvi_output_kind kind;
  double mean_error, largest_error; /* measured over the validation set, absolute */
} rbvi_output;

/* 0 for a model that is none. */
RBVI_API size_t rbvi_parameter_count(const rbvi_model *model);
RBVI_API size_t rbvi_output_count(const rbvi_model *model);
RBVI_API rbvi_status rbvi_parameter_at(const rbvi_model *model, size_t i, rbvi_parameter *parameter);
/* The value of parameter i that a text says: a number, or the name of a choice. */
RBVI_API rbvi_status rbvi_value(const rbvi_model *model, size_t i, const char *text, double *value);
RBVI_API rbvi_status rbvi_output_at(const rbvi_model *model, size_t i, rbvi_output *output);
/* What parameters have to meet together, one line each: "condition: why". */
RBVI_API size_t rbvi_requirement_count(const rbvi_model *model);
RBVI_API rbvi_status rbvi_requirement_at(const rbvi_model *model, size_t i, const char **text);
/* The name of the scene. */
RBVI_API rbvi_status rbvi_scene(const rbvi_model *model, const char **name);

RBVI_API rbvi_status rbvi_workspace_new(const rbvi_model *model, rbvi_workspace **workspace);
RBVI_API void rbvi_workspace_free(rbvi_workspace *workspace);

/* `mu`: a value of each parameter; `options`: a sum of rbvi_option. */
RBVI_API rbvi_status rbvi_solve(rbvi_workspace *workspace, const double *mu, unsigned options);

/* Of the last rbvi_solve of this workspace, which must have had an answer. */
RBVI_API rbvi_status rbvi_outputs(rbvi_workspace *workspace, double *values);
/* Beside each output its largest error over the validation set, absolute; and a bound of the
 * error of this answer where the model has one (of the energy, made with -certify). NaN where there is
 * none, the first outside of the box. Either may be null. */
RBVI_API rbvi_status rbvi_errors(rbvi_workspace *workspace, double *expected, double *bounds);

/* Derivatives of the outputs by the parameters, of the last rbvi_solve: `values` outputs x
 * parameters, row by row; NaN where an output counts, or is a check of the answer. `kinked`: one for
 * each parameter, 1 where a node is about to touch, lift, stick or slip, so that derivatives are
 * those of one side, or between both; may be null. */
RBVI_API rbvi_status rbvi_gradients(rbvi_workspace *workspace, double *values, int *kinked);

typedef struct rbvi_answer {
  int inside;        /* of the box */
  double residual;   /* of the reduced problem, relative */
  double seconds;    /* the answer and its outputs */
  double error_u;    /* largest relative errors over the validation set: displacement, */
  double error_multipliers; /* multipliers */
  double to_other;   /* > 0: the law of friction has another answer, so far away, relative */
} rbvi_answer;
RBVI_API rbvi_status rbvi_answer_of(rbvi_workspace *workspace, rbvi_answer *answer);

/* Many parameters at once: `mu` rows x parameters, row by row; `outputs` rows x outputs; `residuals`
 * and `statuses` one of each row, which may be null. A row without an answer has outputs NaN and its
 * status; `threads` 0: one for each core. The answers do not depend on the number of threads. Bad
 * input in a row is the status of the row. `reasons`: may be null; else text(row, reason, context)
 * is called for each row without an answer, one at a time. */
typedef void (*rbvi_reason)(size_t row, const char *reason, void *context);
RBVI_API rbvi_status rbvi_solve_many(const rbvi_model *model, const double *mu, size_t rows,
                                     unsigned threads, unsigned options, double *outputs,
                                     double *residuals, rbvi_status *statuses, rbvi_reason reasons,
                                     void *context);

/* Values on a mesh, of the last answer; valid until the next call with this workspace. */
typedef struct rbvi_grid {
  size_t nodes, dimension, cells, nodes_per_cell, columns;
  const double *points;  /* nodes x dimension, row by row, mapped */
  const int *cell_nodes; /* cells x nodes_per_cell: lines, triangles, tetrahedra */
} rbvi_grid;

typedef struct rbvi_column {
  const char *name, *unit;
  int of_cells;      /* values are of cells, else of nodes */
  size_t components; /* of each value, side by side */
  const double *values;
} rbvi_column;

RBVI_API size_t rbvi_contact_count(const rbvi_model *model);
RBVI_API rbvi_status rbvi_contact_name(const rbvi_model *model, size_t contact, const char **name);
/* The trace on a contact: pressure, gap, normal, displacement, ... */
RBVI_API rbvi_status rbvi_contact(rbvi_workspace *workspace, size_t contact, rbvi_grid *grid);
/* The bodies: displacement, stresses. Of a model that was packed with its fields. */
RBVI_API rbvi_status rbvi_field(rbvi_workspace *workspace, rbvi_grid *grid);
/* Column i of the grid that was asked for last. */
RBVI_API rbvi_status rbvi_column_at(rbvi_workspace *workspace, size_t i, rbvi_column *column);

#ifdef __cplusplus
}
#endif

#endif
