"""Instants at which contact opens or closes, and steps that respect them."""
