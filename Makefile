# `make check` is exactly what continuous integration runs; the other targets use the current environment.
.PHONY: check lint format test coverage docs pictures validation

check:
	bash .ci/run

lint:
	ruff check .
	ruff format --check .
	pyright
	lint-imports

format:
	ruff check --fix .
	ruff format .

test:
	python -m pytest -n 2

# Counts what every process of the tests runs: this one, commands, workers of studies and clusters.
coverage:
	rm -rf build/coverage && mkdir -p build/coverage
	python -m coverage run -m pytest -m "slow or not slow" -n 2
	python -m coverage combine --quiet
	python -m coverage report --sort=cover

docs:
	sphinx-build -W --keep-going -b html docs build/docs

# Draws the pictures of the documentation anew, from lines and passages that are computed for them.
pictures:
	python docs/_ext/pictures.py

# Runs every test and stores the rows of the validation table that the documentation shows.
validation:
	python -m pytest -m "slow or not slow" -n 2
	cp build/validation.json docs/validation.json
