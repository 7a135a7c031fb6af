# Images of Passo; docs/how-to/run-in-a-container.md describes them.
#   docker build -t passo .                          one printer, simulated unless its command is changed; or a hub
#   docker build -t passo-worker --target worker .   computes cases of studies

FROM debian:12-slim AS build
RUN apt-get update \
 && apt-get install -y --no-install-recommends ca-certificates g++ make python3-dev python3-venv \
 && rm -rf /var/lib/apt/lists/*
WORKDIR /build
COPY . .
RUN make wheel
# The versions of the tests, as constraints without hashes: the wheel has none.
RUN sed -n 's/^\([A-Za-z0-9._-]*==[^\\]*\).*/\1/p' requirements/run.lock requirements/dev.lock > versions.txt \
 && python3 -m venv /opt/passo \
 && /opt/passo/bin/pip install -q --no-cache-dir -c versions.txt "$(echo dist/passo-*.whl)[web,hub,mdns,resonance]"

FROM build AS build-worker
RUN /opt/passo/bin/pip install -q --no-cache-dir -c versions.txt "$(echo dist/passo-*.whl)[cluster]"

FROM debian:12-slim AS base
RUN apt-get update \
 && apt-get install -y --no-install-recommends python3 \
 && rm -rf /var/lib/apt/lists/* \
 && useradd --system --uid 1000 --groups dialout --home-dir /var/lib/passo passo \
 && install -d -o passo -g passo /var/lib/passo /var/lib/passo/card
ENV PATH=/opt/passo/bin:$PATH PYTHONUNBUFFERED=1
USER passo
WORKDIR /var/lib/passo

FROM base AS worker
COPY --from=build-worker /opt/passo /opt/passo
ENTRYPOINT ["dask", "worker", "--nworkers", "auto", "--nthreads", "1", "--no-dashboard"]

# The last stage is the one that is built without --target.
FROM base AS printer
COPY --from=build /opt/passo /opt/passo
VOLUME /var/lib/passo
EXPOSE 4000 4100
ENTRYPOINT ["passo"]
CMD ["serve", "--simulated", "--machine", "i3", "--http", "0.0.0.0:4000", "--tcp", "127.0.0.1:2323", "--sd", "card", "--state", "."]
