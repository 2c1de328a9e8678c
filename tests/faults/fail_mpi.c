// SPDX-License-Identifier: MIT
// Preloaded into ranks beside fail_call.c: the n-th call of MPI fails, as the library lets it fail.
//   CUBOCT_FAIL_CALL  mpi
//   CUBOCT_FAIL_AT    which of them, from 1
//   CUBOCT_FAIL_RANK  in which rank
//   CUBOCT_FAIL_KILLS, CUBOCT_FAIL_MARK  as in fail_call.c
#include <fcntl.h>
#include <mpi.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int fails(const char* function) {
  static long count, at = -1;
  if (at < 0) {
    const char *call = getenv("CUBOCT_FAIL_CALL"), *number = getenv("CUBOCT_FAIL_AT"), *rank = getenv("CUBOCT_FAIL_RANK"),
               *here = getenv("OMPI_COMM_WORLD_RANK");
    const int armed = call != NULL && number != NULL && here != NULL && strcmp(call, "mpi") == 0 && rank != NULL && strcmp(rank, here) == 0;
    at = armed ? atol(number) : 0;
  }
  if (at == 0 || ++count != at) return 0;
  const char* const mark = getenv("CUBOCT_FAIL_MARK");
  const int file = mark == NULL ? -1 : open(mark, O_WRONLY | O_CREAT | O_TRUNC, 0666);
  if (file >= 0) {
    if (write(file, function, strlen(function)) < 0 || write(file, " 0", 2) < 0) abort();
    close(file);
  }
  if (getenv("CUBOCT_FAIL_KILLS") != NULL) kill(getpid(), SIGKILL);
  MPI_Comm_call_errhandler(MPI_COMM_WORLD, MPI_ERR_INTERN);  // as MPI itself would; by default the end of all ranks
  return 1;
}

#define FAILS(name, declared, given) \
  int name declared { return fails(#name) ? MPI_ERR_INTERN : P##name given; }

FAILS(MPI_Comm_split_type, (MPI_Comm of, int kind, int key, MPI_Info info, MPI_Comm* made), (of, kind, key, info, made))
FAILS(MPI_Ibarrier, (MPI_Comm comm, MPI_Request* request), (comm, request))
FAILS(MPI_Iallreduce, (const void* from, void* to, int count, MPI_Datatype type, MPI_Op op, MPI_Comm comm, MPI_Request* request),
      (from, to, count, type, op, comm, request))
FAILS(MPI_Ialltoall,
      (const void* from, int sent, MPI_Datatype type, void* to, int received, MPI_Datatype other, MPI_Comm comm, MPI_Request* request),
      (from, sent, type, to, received, other, comm, request))
FAILS(MPI_Ialltoallv,
      (const void* from, const int* sent, const int* at, MPI_Datatype type, void* to, const int* received, const int* where, MPI_Datatype other,
       MPI_Comm comm, MPI_Request* request),
      (from, sent, at, type, to, received, where, other, comm, request))
FAILS(MPI_Iallgather,
      (const void* from, int sent, MPI_Datatype type, void* to, int received, MPI_Datatype other, MPI_Comm comm, MPI_Request* request),
      (from, sent, type, to, received, other, comm, request))
FAILS(MPI_Iallgatherv,
      (const void* from, int sent, MPI_Datatype type, void* to, const int* received, const int* where, MPI_Datatype other, MPI_Comm comm,
       MPI_Request* request),
      (from, sent, type, to, received, where, other, comm, request))
FAILS(MPI_Irecv, (void* to, int count, MPI_Datatype type, int rank, int tag, MPI_Comm comm, MPI_Request* request),
      (to, count, type, rank, tag, comm, request))
FAILS(MPI_Isend, (const void* from, int count, MPI_Datatype type, int rank, int tag, MPI_Comm comm, MPI_Request* request),
      (from, count, type, rank, tag, comm, request))
