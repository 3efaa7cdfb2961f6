# The planning service. Build: docker build -t assur .   Run: docker run -p 8000:8000 assur
# docs/service.md has the run with everything locked down.

FROM python:3.11-slim-bookworm AS build
ENV PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_NO_CACHE_DIR=1
RUN python -m venv /opt/assur
WORKDIR /src
# The libraries first, as a layer of their own: it is built anew only when pyproject.toml changes.
COPY pyproject.toml LICENSE ./
RUN mkdir src && /opt/assur/bin/pip install .
COPY planner planner
COPY scenes scenes
COPY api api
COPY experiments experiments
COPY src src
RUN /opt/assur/bin/pip install --no-deps --force-reinstall .
# Compiled here, for any processor of this architecture: a container compiles nothing and writes nothing.
ENV NUMBA_CACHE_DIR=/opt/assur/kernels NUMBA_CPU_NAME=generic NUMBA_CPU_FEATURES=""
RUN /opt/assur/bin/assur kernels

FROM python:3.11-slim-bookworm
COPY --from=build /opt/assur /opt/assur
# Nothing is written at run time: the byte code was compiled above, logs go to standard error.
ENV PATH=/opt/assur/bin:$PATH \
    HOME=/tmp \
    PYTHONDONTWRITEBYTECODE=1 \
    PYTHONUNBUFFERED=1 \
    ASSUR_DRAIN_S=5 \
    NUMBA_CACHE_DIR=/opt/assur/kernels \
    NUMBA_CPU_NAME=generic \
    NUMBA_CPU_FEATURES=""
WORKDIR /opt/assur
USER 10001:10001
EXPOSE 8000
STOPSIGNAL SIGTERM
HEALTHCHECK --interval=10s --timeout=3s --start-period=60s --retries=3 \
    CMD ["python", "-c", "from urllib.request import urlopen; urlopen('http://127.0.0.1:8000/readyz', timeout=2)"]
CMD ["assur", "serve", "--host", "0.0.0.0", "--port", "8000"]
