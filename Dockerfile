# The planning service. docs/deployment.md says how it is built from a base by its digest, and run with everything
# locked down.   docker build -t assur .   docker run -p 8000:8000 assur

# The tag moves. `make image` puts a base by its digest in its place (--build-context), the one in deploy/base-image.
FROM python:3.11-slim-bookworm AS build
ENV PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_NO_CACHE_DIR=1 PIP_ROOT_USER_ACTION=ignore
# What builds stays in an environment of its own. The image's environment has no pip: that of the base installs into it.
RUN python -m venv /opt/build && python -m venv --without-pip /opt/assur
WORKDIR /src
# The libraries first, as layers of their own: they are built anew only when a lock file changes.
COPY deploy/requirements-build.lock deploy/
RUN /opt/build/bin/pip install --require-hashes -r deploy/requirements-build.lock
COPY deploy/requirements.lock deploy/
RUN /opt/build/bin/pip --python /opt/assur/bin/python install --require-hashes --no-deps -r deploy/requirements.lock
# Tests that libraries ship are not run here.
RUN find /opt/assur/lib -type d -name tests -path '*/site-packages/*' -prune -exec rm -rf {} +
COPY pyproject.toml LICENSE ./
COPY planner planner
COPY scenes scenes
COPY api api
COPY experiments experiments
COPY prover prover
COPY src/assur/__init__.py src/assur/request.py src/assur/py.typed src/assur/
COPY deploy/packaging deploy/packaging
RUN /opt/build/bin/pip wheel --no-build-isolation --no-deps --no-index --wheel-dir /wheel . \
    && /opt/build/bin/pip --python /opt/assur/bin/python install --no-deps --no-index /wheel/*.whl
COPY deploy/sbom.py deploy/
RUN /opt/build/bin/python -m deploy.sbom /opt/assur/bin/python /opt/assur/sbom.cdx.json
COPY deploy/healthy.sh /opt/assur/bin/healthy
# Compiled here, for any processor of this architecture: a container compiles nothing and writes nothing.
ENV NUMBA_CACHE_DIR=/opt/assur/kernels NUMBA_CPU_NAME=generic NUMBA_CPU_FEATURES=""
RUN /opt/assur/bin/assur kernels

FROM python:3.11-slim-bookworm
# Nothing is installed in a container: the base's own pip goes, too.
RUN python -m pip uninstall --yes --quiet --root-user-action=ignore pip setuptools wheel
COPY --from=build /opt/assur /opt/assur
# Nothing is written at run time: the byte code was compiled above, logs go to standard error.
ENV PATH=/opt/assur/bin:$PATH \
    HOME=/tmp \
    PYTHONDONTWRITEBYTECODE=1 \
    PYTHONUNBUFFERED=1 \
    ASSUR_DRAIN_S=5 \
    NUMBA_CACHE_DIR=/opt/assur/kernels \
    NUMBA_CPU_NAME=generic \
    NUMBA_CPU_FEATURES="" \
    ASSUR_HOST=0.0.0.0 \
    ASSUR_PORT=8000
# Last, for they change with each commit.
ARG VERSION=0.1.0
ARG COMMIT=
ENV ASSUR_COMMIT=$COMMIT
LABEL org.opencontainers.image.title="assur" \
      org.opencontainers.image.description="Certified jerk-limited motion of SCARA-class robots, as a service" \
      org.opencontainers.image.licenses="MIT" \
      org.opencontainers.image.version=$VERSION \
      org.opencontainers.image.revision=$COMMIT
# For ASSUR_MESH_FOLDER, where a volume is mounted there.
RUN install --directory --owner=10001 --group=10001 /var/lib/assur/meshes
WORKDIR /opt/assur
USER 10001:10001
EXPOSE 8000
STOPSIGNAL SIGTERM
HEALTHCHECK --interval=10s --timeout=3s --start-period=60s --retries=3 CMD ["healthy"]
CMD ["assur", "serve"]
